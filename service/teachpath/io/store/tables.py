"""The tables. What is searched is a column; what is only carried along is a JSON document (io/documents)."""

from __future__ import annotations

from typing import Any, Final

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Float,
    ForeignKey,
    Index,
    Integer,
    String,
    Text,
    UniqueConstraint,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

ID = String(64)
NEWEST_REVISION: Final = "0019"  # of the migrations


class Base(DeclarativeBase):
    """Base of the tables."""


class ServiceRow(Base):
    """A process that works for a station, with the time of its last sign of life."""

    __tablename__ = "services"
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    station: Mapped[str] = mapped_column(ID)
    role: Mapped[str] = mapped_column(String(16))
    place: Mapped[str] = mapped_column(Text)
    alive_ns: Mapped[int] = mapped_column(BigInteger)


class TaskRow(Base):
    """A task: what is demonstrated."""

    __tablename__ = "tasks"
    name: Mapped[str] = mapped_column(ID, primary_key=True)
    scene: Mapped[str] = mapped_column(ID)
    calibration: Mapped[str] = mapped_column(ID)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    object_at_grasp: Mapped[bool] = mapped_column(Boolean)
    archived_ns: Mapped[int] = mapped_column(BigInteger)  # 0: it was not deleted
    display_name: Mapped[str] = mapped_column(Text)  # empty: the name


class DemonstrationRow(Base):
    """A demonstration; its samples are in the recording."""

    __tablename__ = "demonstrations"
    __table_args__: tuple[Any, ...] = (UniqueConstraint("task", "number"),)
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    task: Mapped[str] = mapped_column(ForeignKey("tasks.name"), index=True)
    number: Mapped[int] = mapped_column(Integer)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    verdict: Mapped[str] = mapped_column(String(16))
    document: Mapped[dict[str, Any]] = mapped_column(JSON)
    station: Mapped[str] = mapped_column(ID)


class CalibrationRow(Base):
    """One version of a calibration that was measured."""

    __tablename__ = "calibrations"
    name: Mapped[str] = mapped_column(ID, primary_key=True)
    version: Mapped[int] = mapped_column(Integer, primary_key=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class ArmRow(Base):
    """One version of an arm that a user brought."""

    __tablename__ = "arms"
    name: Mapped[str] = mapped_column(ID, primary_key=True)
    version: Mapped[int] = mapped_column(Integer, primary_key=True)
    hash: Mapped[str] = mapped_column(ID)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class SceneRow(Base):
    """One version of a scene that was changed."""

    __tablename__ = "scenes"
    name: Mapped[str] = mapped_column(ID, primary_key=True)
    version: Mapped[int] = mapped_column(Integer, primary_key=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    author: Mapped[str] = mapped_column(Text)
    note: Mapped[str] = mapped_column(Text)
    removed: Mapped[bool] = mapped_column(Boolean)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class RunTable(Base):
    """A learning run over a task's demonstrations; `summary` is what a list says of it (`RunSummary`)."""

    __tablename__ = "runs"
    __table_args__: tuple[Any, ...] = (Index("ix_runs_task_created_ns", "task", "created_ns", "id"),)
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    task: Mapped[str] = mapped_column(ForeignKey("tasks.name"), index=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    summary: Mapped[dict[str, Any]] = mapped_column(JSON)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class PathRow(Base):
    """One version of a learned path."""

    __tablename__ = "paths"
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    version: Mapped[int] = mapped_column(Integer, primary_key=True)
    run: Mapped[str] = mapped_column(ForeignKey("runs.id"), index=True)
    parent: Mapped[int | None] = mapped_column(Integer)
    branch: Mapped[str] = mapped_column(ID)
    name: Mapped[str] = mapped_column(Text)
    author: Mapped[str] = mapped_column(Text)
    note: Mapped[str] = mapped_column(Text)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class PlanRow(Base):
    """A plan with its certificate."""

    __tablename__ = "plans"
    __table_args__: tuple[Any, ...] = (Index("ix_plans_path_created_ns", "path", "created_ns", "id"),)
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    path: Mapped[str] = mapped_column(ID, index=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)


class JobRow(Base):
    """Background work and how it stands."""

    __tablename__ = "jobs"
    __table_args__: tuple[Any, ...] = (Index("ix_jobs_task_created_ns", "task", "created_ns", "id"),)
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    task: Mapped[str] = mapped_column(ID, index=True)
    kind: Mapped[str] = mapped_column(String(16))
    state: Mapped[str] = mapped_column(String(16), index=True)
    request: Mapped[dict[str, Any]] = mapped_column(JSON)
    fraction: Mapped[float] = mapped_column(Float)
    message: Mapped[str] = mapped_column(Text)
    outcome: Mapped[str] = mapped_column(ID)
    attempt: Mapped[int] = mapped_column(Integer)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    finished_ns: Mapped[int] = mapped_column(BigInteger)
    failure: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    demonstration: Mapped[str] = mapped_column(ID)
    who: Mapped[str] = mapped_column(ID)
    station: Mapped[str] = mapped_column(ID)
    service: Mapped[str] = mapped_column(ID, default="")  # which does it; empty: none yet
    cancel: Mapped[bool] = mapped_column(Boolean, default=False)  # that service is to break it off


class ExecutionTable(Base):
    """An execution of a plan, or without one of a live hand, and its last known status."""

    __tablename__ = "executions"
    __table_args__: tuple[Any, ...] = (Index("ix_executions_created_ns", "created_ns", "id"),)
    id: Mapped[str] = mapped_column(ID, primary_key=True)
    plan: Mapped[str | None] = mapped_column(ForeignKey("plans.id"), index=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    document: Mapped[dict[str, Any]] = mapped_column(JSON)
    station: Mapped[str] = mapped_column(ID)


class RevocationRow(Base):
    """A plan whose certificate holds no longer."""

    __tablename__ = "revocations"
    plan: Mapped[str] = mapped_column(ForeignKey("plans.id"), primary_key=True)
    at_ns: Mapped[int] = mapped_column(BigInteger)
    who: Mapped[str] = mapped_column(ID)
    reason: Mapped[str] = mapped_column(Text)


class AccessTokenRow(Base):
    """A token by which a program says who it is: its hash."""

    __tablename__ = "access_tokens"
    digest: Mapped[str] = mapped_column(ID, primary_key=True)
    name: Mapped[str] = mapped_column(ID, index=True)
    roles: Mapped[list[str]] = mapped_column(JSON)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    expires_ns: Mapped[int] = mapped_column(BigInteger)
    used_ns: Mapped[int] = mapped_column(BigInteger)
    revoked_ns: Mapped[int] = mapped_column(BigInteger)


class PersonRow(Base):
    """Somebody who signs in: the hash of the password, or who it is at a provider."""

    __tablename__ = "people"
    name: Mapped[str] = mapped_column(ID, primary_key=True)
    roles: Mapped[list[str]] = mapped_column(JSON)
    password_hash: Mapped[str] = mapped_column(Text)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    changed_ns: Mapped[int] = mapped_column(BigInteger)
    issuer: Mapped[str] = mapped_column(Text)
    subject: Mapped[str] = mapped_column(Text)


class SessionRow(Base):
    """A person who has signed in: the hash of the session's secret."""

    __tablename__ = "sessions"
    digest: Mapped[str] = mapped_column(ID, primary_key=True)
    person: Mapped[str] = mapped_column(ForeignKey("people.name"), index=True)
    created_ns: Mapped[int] = mapped_column(BigInteger)
    used_ns: Mapped[int] = mapped_column(BigInteger)


class JournalRow(Base):
    """Who did what to the arm, and how that was answered."""

    __tablename__ = "journal"
    number: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    at_ns: Mapped[int] = mapped_column(BigInteger)
    who: Mapped[str] = mapped_column(ID)
    verb: Mapped[str] = mapped_column(String(32))
    execution: Mapped[str] = mapped_column(ID, index=True)
    answer: Mapped[str] = mapped_column(Text)
