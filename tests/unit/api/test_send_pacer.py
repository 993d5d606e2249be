import asyncio
import threading
from itertools import pairwise

from teachpath.api.send_pacer import SENDERS_A_ROUND, SendPacer


def test_in_each_round_of_the_loop_a_few_senders_send_and_each_its_turn() -> None:
    sent: list[int] = []
    sent_before: list[int] = []  # in each round of the loop

    async def sender(number: int, event: asyncio.Event) -> None:
        await event.wait()
        sent.append(number)

    async def run() -> None:
        pacer = SendPacer(asyncio.get_running_loop())
        events = [asyncio.Event() for _ in range(50)]
        tasks = [asyncio.create_task(sender(number, event)) for number, event in enumerate(events)]
        await asyncio.sleep(0)
        waker = threading.Thread(target=lambda: [pacer.wake(event) for event in (*events, *events)])
        waker.start()
        while not all(task.done() for task in tasks):
            sent_before.append(len(sent))
            await asyncio.sleep(0)
        waker.join()

    asyncio.run(run())
    assert sent == list(range(50))
    assert all(after - before <= SENDERS_A_ROUND for before, after in pairwise(sent_before))


def test_a_loop_that_has_ended_is_woken_no_more() -> None:
    async def made() -> SendPacer:
        return SendPacer(asyncio.get_running_loop())

    pacer = asyncio.run(made())
    pacer.wake(asyncio.Event())
