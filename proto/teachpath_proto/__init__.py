"""The contract on the wire: protobuf messages and Zenoh keys that clients and service share."""

__version__ = "0.1.0"
