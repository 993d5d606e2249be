"""Devices that a hand is measured with: one source contract, drivers behind it, and their emulators."""

from teachpath_client.devices.source import Capabilities, Source, TouchSource, configure, describe_sources, open_source

__all__ = ["Capabilities", "Source", "TouchSource", "configure", "describe_sources", "open_source"]
