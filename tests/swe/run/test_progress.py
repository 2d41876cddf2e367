"""What the bar of a run shows."""

from swe.run.progress import ProgressBar


def test_the_bar_tells_days_speed_and_courant_number() -> None:
    with ProgressBar(2.0, 10.0, visible=False) as bar:
        (task,) = bar._progress.tasks
        assert (task.completed, task.total) == (2.0, 10.0)
        bar.show_courant_number(0.75)
        bar.update(10.0)
        assert task.fields["courant"] == 0.75
        assert task.completed == 10.0
        minutes = 8.0 / task.fields["speed"]
        assert 0.0 < minutes < 1.0


def test_the_bar_is_not_redrawn_more_than_ten_times_a_second() -> None:
    with ProgressBar(0.0, 10.0, visible=False) as bar:
        bar.update(1.0)
        (task,) = bar._progress.tasks
        assert task.completed == 0.0
        bar._shown -= 1.0
        bar.update(2.0)
        assert task.completed == 2.0
