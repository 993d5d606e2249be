"""The simulated arm, in a process of its own."""

from teachpath.workers.simulator.settings import SimulatorSettings
from teachpath.workers.simulator.worker import Simulator

__all__ = ["Simulator", "SimulatorSettings"]
