"""Timing of a stepping loop."""
import time

MIN_SECONDS, MAX_REPEATS = 0.2, 50  # total time of the loops, s; number of loops


def minimum_seconds(prepare, loop):
    """Returns the minimum CPU seconds of loop(prepare()), and the result of the last prepare()."""
    minimum, spent = float("inf"), 0.0
    for _ in range(MAX_REPEATS):
        state = prepare()
        start = time.process_time()
        loop(state)
        seconds = time.process_time() - start
        minimum, spent = min(minimum, seconds), spent + seconds
        if spent >= MIN_SECONDS:
            break
    return minimum, state
