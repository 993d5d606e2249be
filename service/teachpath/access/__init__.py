"""Who may do what: how a station tells who asks, and who may reach it at all."""
