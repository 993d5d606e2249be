"""Executions: move the arm along a certified plan, and steer it."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from teachpath.api.parts import Parts
from teachpath.io.store import ExecutionRow


class NewExecution(BaseModel):
    """A plan to execute."""

    plan: str = Field(description="id of a plan; only a plan with a valid certificate moves the arm")
    override: float = Field(1.0, ge=0.0, le=1.0, description="share of the planned speed")


class Speed(BaseModel):
    """A speed override."""

    override: float = Field(ge=0.0, le=1.0, description="share of the planned speed")


def executions_router(parts: Parts) -> APIRouter:
    """Return the routes of executions."""
    router = APIRouter(tags=["executions"])
    executions, store = parts.executions, parts.store

    @router.get("/executions")
    def list_executions() -> list[ExecutionRow]:
        """List the newest executions, newest first."""
        return [executions.get(row.id) for row in store.executions()]

    @router.post("/executions", status_code=202)
    def begin_execution(new: NewExecution, response: Response) -> ExecutionRow:
        """Move the arm: approach, grasp, follow the path, release, retreat."""
        row = executions.begin(new.plan, override=new.override)
        response.headers["Location"] = f"/api/v1/executions/{row.id}"
        return row

    @router.get("/executions/{execution}")
    def get_execution(execution: str) -> ExecutionRow:
        """Return how an execution stands."""
        return executions.get(execution)

    @router.post("/executions/{execution}/override")
    def set_override(execution: str, speed: Speed) -> ExecutionRow:
        """Change the speed while the arm moves; 0 is a hold on the path."""
        return executions.command(execution, "override", override=speed.override)

    @router.post("/executions/{execution}/{verb}")
    def steer(execution: str, verb: Literal["hold", "resume", "reverse", "stop"]) -> ExecutionRow:
        """Hold on the path, resume, go back along it, or stop and end. This is not an emergency stop."""
        return executions.command(execution, verb)

    return router
