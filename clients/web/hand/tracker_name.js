// The name under which this page is a tracker.
export const name = `page-${Math.random().toString(36).slice(2, 8)}`;
