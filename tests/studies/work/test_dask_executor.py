"""Jobs on Dask workers: all are done, a failing one is tried twice and reported, a death costs one more try."""

from pathlib import Path

import pytest

from studies.work.dask_executor import dask_executor
from studies.work.workers import Failure, Job
from tests.studies.work import jobs


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # what Dask and its parts warn of is theirs
def test_jobs_fail_alone(tmp_path: Path):
    """Of five jobs one complains at every try and one aborts its worker once; only workers with the resource."""
    from distributed import LocalCluster

    work = [Job(f"job {k}", jobs.note, tmp_path / str(k)) for k in range(3)]
    bad, shaky = Job("bad", jobs.complain, tmp_path / "bad"), Job("shaky", jobs.abort_once, tmp_path / "shaky")
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", resources={"GPU": 1}) as cluster,
        dask_executor(cluster.scheduler_address, "GPU") as crew,
    ):
        failures = crew.run([[*work, bad], [shaky]])
    assert failures == [Failure("bad", "ValueError: no such thing")]
    assert (tmp_path / "bad").read_text() == "xx"
    assert {path.name for path in tmp_path.iterdir()} == {"0", "1", "2", "bad", "shaky", "shaky.tried"}
