"""Waiting for conditions on what callbacks bring, without sleeping for fixed times."""
import threading

WAIT_S = 20.0  # wall time after which a condition counts as never met


class Waiter:
    def __init__(self):
        self.changed = threading.Condition()

    def notify(self):
        with self.changed:
            self.changed.notify_all()

    def wait_for(self, condition, what, timeout_s=WAIT_S):
        with self.changed:
            if not self.changed.wait_for(condition, timeout_s):
                raise AssertionError("never happened: " + what)
