"""How a stepping loop is timed."""
import time

AT_LEAST, MOST_REPEATS = 0.2, 50  # s of loops, repeats


def least_seconds(prepare, loop):
    """Least CPU seconds of loop(prepare()), and what the last prepare() gave."""
    least, spent = float("inf"), 0.0
    for _ in range(MOST_REPEATS):
        state = prepare()
        begin = time.process_time()
        loop(state)
        seconds = time.process_time() - begin
        least, spent = min(least, seconds), spent + seconds
        if spent >= AT_LEAST:
            break
    return least, state
