"""The contract on the wire: protobuf messages and Zenoh keys that clients and service share."""

__version__ = "1.0.0"
