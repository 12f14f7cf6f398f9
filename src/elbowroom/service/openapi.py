"""The service as OpenAPI 3.1."""

from collections.abc import Sequence
from typing import Any

ERROR = {"type": "object", "required": ["error"], "properties": {"error": {"type": "string"}}}
GATE = {
    "type": "object",
    "required": ["phase", "level", "speed", "reason", "latched", "active", "motions"],
    "properties": {
        "phase": {"type": "string"},
        "level": {"enum": ["stop", "decelerate", "inform", "clear"]},
        "speed": {"type": "number", "minimum": 0, "maximum": 1},
        "reason": {"type": "string"},
        "latched": {"type": "array", "items": {"type": "object"}},
        "active": {"type": "array", "items": {"type": "object"}},
        "motions": {"type": "object"},
    },
}
ONCE = {
    "type": "object",
    "required": ["nonce", "time_ms"],
    "additionalProperties": False,
    "properties": {
        "nonce": {
            "type": "string",
            "pattern": "^[0-9A-Za-z]{16,64}$",
            "description": "another one in each request",
        },
        "time_ms": {"type": "integer", "description": "of sending, milliseconds since 1970, at most 5 s off"},
    },
}
ALWAYS = (400, 403, 408, 413, 429, 431, 503)


def openapi(version: str) -> dict[str, Any]:
    """The description.

    Args:
        version: of elbowroom.
    """
    yes, text = {"type": "boolean"}, {"type": "string"}
    reset = _object(("done", "answer"), {"done": yes, "answer": text, "gate": GATE})
    held, told = _object(("done",), {"done": yes}), _object(("ok",), {"ok": yes, "why": text})
    return {
        "openapi": "3.1.0",
        "info": {"title": "elbowroom control service", "version": version},
        "components": {"securitySchemes": {"token": {"type": "http", "scheme": "bearer"}}},
        "paths": {
            "/health/live": {"get": _asked("live", "The service runs.", told)},
            "/health/ready": {"get": _asked("ready", "Passes are finished in time.", told, 503, told)},
            "/metrics": {"get": _asked("metrics", "Numbers for Prometheus.", None)},
            "/v1/status": {"get": _asked("status", "What the gate says.", GATE)},
            "/v1/reset": {"post": _controlled("reset", "Forgets faults that are over.", reset)},
            "/v1/hold": {"post": _controlled("hold", "A person holds on, now.", held)},
            "/openapi.json": {"get": _asked("openapi", "This description.", {"type": "object"})},
        },
    }


def _object(required: Sequence[str], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "required": list(required), "properties": properties}


def _asked(
    name: str, words: str, answer: dict[str, Any] | None, other: int | None = None, said: Any = ERROR
) -> dict[str, Any]:
    """A question: its answer, one of another status, and those that all have.

    Args:
        name, words: of it.
        answer: schema of what is answered; None: text.
        other, said: another status, and its schema.
    """
    kind = {"text/plain": {}} if answer is None else {"application/json": {"schema": answer}}
    answers: dict[str, Any] = {"200": {"description": words, "content": kind}}
    for status in ALWAYS:
        answers[str(status)] = _refusal(said if status == other else ERROR)
    return {"operationId": name, "summary": words, "responses": answers}


def _controlled(name: str, words: str, answer: dict[str, Any]) -> dict[str, Any]:
    """What needs the token."""
    found = _asked(name, words, answer)
    for status in (401, 409, 415):
        found["responses"][str(status)] = _refusal(ERROR)
    content = {"application/json": {"schema": ONCE}}
    return {**found, "security": [{"token": []}], "requestBody": {"required": True, "content": content}}


def _refusal(schema: dict[str, Any]) -> dict[str, Any]:
    return {"description": "Nothing was done.", "content": {"application/json": {"schema": schema}}}
