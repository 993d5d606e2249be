"""Neither the number of threads nor the cache of compiled kernels changes a bit of what is learned."""

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
from teachpath.learning.clustering.distances import nearest_paths
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
import numpy as np

five = synthetic.turning(synthetic.experiment_2(3))
for settings in (LearningSettings(repeats=1), LearningSettings(mode="paper", threshold=0.3, repeats=1)):
    print(sha256(encode(learn(five, settings))).hexdigest())
rng = np.random.default_rng(3)
crowd = {str(k): synthetic.demonstration(rng, duration=rng.uniform(0.8, 1.2)) for k in range(205)}
print(sha256(encode(learn(crowd, LearningSettings(repeats=0)))).hexdigest())
many = 0.05 * np.random.default_rng(1).normal(size=(210, 100, 3)).cumsum(axis=1)
found = cluster_paths(many, LearningSettings(), length=1.0, metric="arc")
print(sha256(found.linkage.tobytes() + found.labels.tobytes()).hexdigest())
index, apart = nearest_paths(many, many[::7], "arc")
print(sha256(index.tobytes() + apart.tobytes()).hexdigest())
"""


def learned_with(threads: int, cache: Path) -> str:
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    places = {"PYTHONPATH": str(Path(__file__).parents[3]), "NUMBA_CACHE_DIR": str(cache)}
    environment = os.environ | dict.fromkeys(names, str(threads)) | places
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, check=True, capture_output=True, text=True)
    return done.stdout


def test_the_first_run_after_an_installation_and_every_later_one_give_the_same_bits(tmp_path: Path) -> None:
    compiled = learned_with(1, tmp_path)
    assert len(compiled.split()) == 5
    assert list(tmp_path.rglob("*_fill*.nbc"))
    assert list(tmp_path.rglob("*_reduced*.nbc"))
    assert learned_with(2, tmp_path) == compiled
