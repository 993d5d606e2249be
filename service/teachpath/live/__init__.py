"""What the page sees live: events, and the 3-D preview."""
