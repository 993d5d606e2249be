"""The recorder: samples from trackers become takes, and takes become demonstrations."""
