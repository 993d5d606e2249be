"""Control of the arm over REST, and the journal."""

from dataclasses import asdict

from teachpath.executor.lease import ControlLease
from teachpath.io.wire import decode_lease_request, encode_lease
from teachpath.records import JournalEntry
from teachpath_proto.control import JournalVerb
from tests.contract.desk import Desk, refused


def test_control_over_rest_is_that_of_the_executor(desk: Desk) -> None:
    refused(desk.get("/lease"), 503, "nobody answered")
    lease, bus, keys = ControlLease(lambda: 0), desk.station.bus, desk.station.keys
    handle = bus.serve(keys.executor_lease, lambda payload: encode_lease(lease.answer(decode_lease_request(payload))))
    try:
        taken = desk.post("/lease", {"name": "Ada", "seconds": 30})
        assert taken.status_code == 201
        assert taken.json()["holder"] == desk.get("/lease").json()["holder"] == "Ada"
        assert desk.get("/lease").json()["token"] == ""
        refused(desk.post("/lease", {"name": "Bea"}), 409, "Ada is in control; ask for it")
        assert desk.post("/lease/ask", {"name": "Bea"}).json()["asking"] == "Bea"
        mine = {"Teachpath-Lease": taken.json()["token"]}
        assert desk.post("/lease/keep", headers=mine).json()["asking"] == ""
        assert desk.post("/lease/beat", headers=mine).json()["expires_in"] == 30.0
        refused(desk.post("/lease/beat", headers={"Teachpath-Lease": "stale"}), 409, "acquire it again")
        refused(desk.post("/lease/beat"), 422, "header.Teachpath-Lease")
        assert desk.post("/lease/release", headers=mine).json()["holder"] == ""
    finally:
        handle.close()


def test_the_journal_is_stored_and_listed(desk: Desk) -> None:
    entries = [JournalEntry(n, "Ada", JournalVerb.HOLD, f"execution-{n}", "done") for n in (1, 2)]
    for entry in entries:
        desk.station.store.journal.write(entry)
    listed = [e for e in desk.get("/journal").json() if e["who"] == "Ada"]
    assert listed == [asdict(entry) for entry in reversed(entries)]
    assert desk.get("/journal?execution=execution-1").json() == [asdict(entries[0])]
    refused(desk.get("/journal?limit=0"), 422, "query.limit")
