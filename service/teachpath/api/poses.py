"""Positions and quaternions in requests."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from teachpath.editing import MAX_COORDINATE

Coordinate = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, allow_inf_nan=False)]  # m
Component = Annotated[float, Field(allow_inf_nan=False)]  # of a quaternion
Position = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]  # x, y, z [m]
Quaternion = Annotated[tuple[Component, Component, Component, Component], Strict(False)]  # w, x, y, z
