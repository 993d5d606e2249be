"""REST and WebSocket: one file a resource."""
