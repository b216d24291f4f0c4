"""Jobs in worker processes: all are done, a death costs one more try, nothing outlives the process that started it."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.work import workers
from studies.work.workers import Failure, Job, run_jobs, thread_share, worker_count
from tests.studies.work import jobs


def _jobs(work, folder: Path, count: int) -> list[Job]:
    return [Job(f"job {k}", work, folder / str(k)) for k in range(count)]


def _pids(folder: Path) -> list[str]:
    return [path.read_text() for path in sorted(folder.iterdir()) if path.suffix == ""]


def test_all_jobs_are_done_in_other_processes(tmp_path: Path):
    """Seven jobs, two workers: seven results, of at most two processes, none of them ours."""
    assert run_jobs([_jobs(jobs.note, tmp_path, 7)], 2) == []
    pids = _pids(tmp_path)
    assert len(pids) == 7
    assert 1 <= len(set(pids)) <= 2
    assert str(os.getpid()) not in pids


def test_a_stage_begins_when_the_one_before_is_done(tmp_path: Path):
    """The second stage's job fails unless the files of the first are all there."""
    first = _jobs(jobs.note, tmp_path, 3)
    assert run_jobs([first, [Job("count", _expect_three, tmp_path)]], 3) == []


def _expect_three(folder: Path) -> None:
    assert len(list(folder.iterdir())) == 3


def test_nothing_to_do(tmp_path: Path):
    """No job, no process, no failure."""
    assert run_jobs([[], []], 2) == []


def test_a_death_costs_one_more_try_and_harms_nobody_else(tmp_path: Path):
    """Of five jobs one aborts its process once: all five are done, the aborted one by another process."""
    work = _jobs(jobs.note, tmp_path, 4)
    assert run_jobs([[Job("shaky", jobs.abort_once, tmp_path / "shaky"), *work]], 1) == []
    assert len(_pids(tmp_path)) == 5


def test_a_job_that_always_dies_is_reported(tmp_path: Path):
    """It is begun twice (as MOST_TRIES says), then given up with the signal's name; the others are done."""
    failures = run_jobs([[Job("bad", jobs.abort, tmp_path / "bad.count"), *_jobs(jobs.note, tmp_path, 3)]], 2)
    assert failures == [Failure("bad", "its process was ended by SIGABRT")]
    assert (tmp_path / "bad.count").read_text() == "xx"
    assert len(_pids(tmp_path)) == 3


def test_an_exception_is_reported_in_one_line(tmp_path: Path):
    """Type and message without line breaks; the process lives on and does the other jobs."""
    failures = run_jobs([[Job("bad", jobs.complain, tmp_path / "bad.count"), *_jobs(jobs.note, tmp_path, 2)]], 1)
    assert failures == [Failure("bad", "ValueError: no such thing")]
    assert (tmp_path / "bad.count").read_text() == "xx"
    assert len(set(_pids(tmp_path))) == 1


def test_what_every_job_would_fail_of_stops_them_all(tmp_path: Path):
    """A full disk met by the first of four jobs: tried once, told at once, the others given up of it unbegun."""
    told: list[Failure] = []
    work = [Job("full", jobs.meet_a_full_disk, tmp_path / "count"), *_jobs(jobs.note, tmp_path, 3)]
    failures = run_jobs([work, _jobs(jobs.note, tmp_path, 1)], 1, tell=told.append)
    assert [failure.name for failure in failures] == ["full", "job 0", "job 1", "job 2", "job 0"]
    assert {failure.reason for failure in failures} == {failures[0].reason}
    assert "the disk is full" in failures[0].reason
    assert told == failures
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("count", "x")]


def test_workers_are_replaced_before_they_grow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """With two jobs a worker, five jobs take three processes."""
    monkeypatch.setattr(workers, "MOST_JOBS", 2)
    assert run_jobs([_jobs(jobs.note, tmp_path, 5)], 1) == []
    assert len(set(_pids(tmp_path))) == 3


def test_threads_are_shared_out(tmp_path: Path):
    """Each worker is told its share of the processors before it loads any library: cores over workers, at least 1."""
    cores = len(os.sched_getaffinity(0))
    assert [thread_share(n) for n in (1, cores, 10 * cores)] == [cores, 1, 1]
    assert run_jobs([_jobs(jobs.note_threads, tmp_path, 1)], 1) == []
    assert (tmp_path / "0").read_text() == str(cores)


def test_workers_are_prepared(tmp_path: Path):
    """The preparation runs in the process that does the jobs, with its share of threads."""
    assert run_jobs([_jobs(jobs.note_preparation, tmp_path, 1)], 10_000, jobs.prepare_by_variable) == []
    assert (tmp_path / "0").read_text() == "1"


def test_a_machine_that_cannot_prepare_says_why(tmp_path: Path):
    """The jobs fail with the preparation's own words."""
    failures = run_jobs([_jobs(jobs.note, tmp_path, 1)], 1, jobs.refuse_to_prepare)
    assert failures == [Failure("job 0", "RuntimeError: no renderer here")]
    assert list(tmp_path.iterdir()) == []


PARENT = """
import sys
from pathlib import Path
from studies.cli.main import _stopped_by_signals
from studies.work.workers import Job, run_jobs
from tests.studies.work import jobs
with _stopped_by_signals():
    run_jobs([[Job("slow", getattr(jobs, sys.argv[2]), Path(sys.argv[1]))]], 1)
"""


def _parent_with_busy_worker(out: Path, work: str) -> tuple[subprocess.Popen, int]:
    """A process whose worker is in the middle of a case, and the worker's id."""
    parent = subprocess.Popen([sys.executable, "-c", PARENT, str(out), work], stderr=subprocess.DEVNULL)
    while not (out / "pid").exists() or not (out / "pid").read_text():
        assert parent.poll() is None
        time.sleep(0.02)
    return parent, int((out / "pid").read_text())


def _wait_until_gone(pid: int) -> None:
    for _ in range(1000):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return
        if state == "Z":  # dead, and nobody has asked for its exit status yet
            return
        time.sleep(0.02)
    raise AssertionError(f"process {pid} lives on")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_study_puts_its_cases_away(tmp_path: Path, number: signal.Signals):
    """Ctrl-C and kill reach the worker, which unwinds the case it was writing: nothing of it is left."""
    parent, worker = _parent_with_busy_worker(tmp_path, "linger_in_a_case")
    parent.send_signal(number)
    parent.wait(30)
    _wait_until_gone(worker)
    assert [path.name for path in tmp_path.iterdir()] == ["pid"]


def test_a_worker_that_does_not_listen_is_ended(tmp_path: Path):
    """A worker deaf to SIGTERM is killed after the time of grace; the unfinished case stays hidden."""
    parent, worker = _parent_with_busy_worker(tmp_path, "linger_deaf")
    parent.terminate()
    parent.wait(60)
    _wait_until_gone(worker)
    assert sorted(path.name for path in tmp_path.iterdir()) == [".partial-abc", "pid"]


def test_workers_do_not_outlive_a_killed_study(tmp_path: Path):
    """kill -9 of the parent leaves nobody behind who would hold the cases when the command is given again."""
    parent, worker = _parent_with_busy_worker(tmp_path, "linger_in_a_case")
    parent.kill()
    parent.wait(30)
    _wait_until_gone(worker)
    assert sorted(path.name for path in tmp_path.iterdir()) == [".partial-abc", "pid"]


def test_number_of_workers():
    """As many as wanted, by default one for each processor, and never none."""
    assert worker_count(3) == 3
    assert worker_count(None) == len(os.sched_getaffinity(0))
    with pytest.raises(InputError, match="--workers 0"):
        worker_count(0)
