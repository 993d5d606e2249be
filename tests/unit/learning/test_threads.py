"""The number of threads changes no bit of what is learned."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

SCRIPT = """
from hashlib import sha256
from tests.unit.learning import synthetic
from teachpath.io.documents import encode
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
import numpy as np

five = synthetic.turning(synthetic.experiment_2(3))
for settings in (LearningSettings(repeats=1), LearningSettings(mode="paper", threshold=0.3, repeats=1)):
    print(sha256(encode(learn(five, settings))).hexdigest())
many = synthetic.loop(20) + np.random.default_rng(1).normal(0, 0.05, (210, 1, 3))
found = cluster_paths(many, LearningSettings(), length=1.0, metric="arc")
print(sha256(found.linkage.tobytes() + found.labels.tobytes()).hexdigest())
"""


def learned_with(threads: int) -> str:
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    environment = os.environ | dict.fromkeys(names, str(threads)) | {"PYTHONPATH": str(Path(__file__).parents[3])}
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, check=True, capture_output=True, text=True)
    return done.stdout


def test_one_thread_or_two_give_the_same_bits() -> None:
    alone = learned_with(1)
    assert len(alone.split()) == 3
    assert learned_with(2) == alone
