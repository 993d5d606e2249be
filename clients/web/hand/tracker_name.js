// This page's name as a tracker.
export const TRACKER_NAME = `page-${Math.random().toString(36).slice(2, 8)}`;
