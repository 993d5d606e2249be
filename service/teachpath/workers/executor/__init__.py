"""The executor: streams the setpoints of one plan at a time to the arm, in a process of its own."""

from teachpath.workers.executor.settings import ExecutorSettings
from teachpath.workers.executor.worker import Executor

__all__ = ["Executor", "ExecutorSettings"]
