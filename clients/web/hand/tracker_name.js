// This page's name as a tracker, and the secret by which the page alone comes back under it.
export const TRACKER_NAME = `page-${Math.random().toString(36).slice(2, 8)}`;
export const TRACKER_SESSION = [...crypto.getRandomValues(new Uint32Array(4))].map((n) => n.toString(36)).join("");
