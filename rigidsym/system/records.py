"""Immutable records and named tuples that need no code of their own for each class.

`dataclass` compiles six functions for a class, in 0.7 ms, and `typing.NamedTuple` one and each
annotation, in 0.2 ms. A start loads a hundred of both.
"""

from __future__ import annotations

import collections
from collections.abc import Set
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from inspect import Parameter, Signature
from operator import attrgetter
from typing import TYPE_CHECKING, Any, ClassVar, dataclass_transform


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class Record:
    """Fields that are set once; records of one class with equal fields are equal.

    `dataclasses.fields` and `replace` take records.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]
    __match_args__: ClassVar[tuple[str, ...]]  # what is set by position
    __signature__: ClassVar[Signature]
    _names: ClassVar[Set[str]]
    _required: ClassVar[Set[str]]
    _count: ClassVar[int]  # of values by position, if these are all
    _key: ClassVar[attrgetter[Any]]  # what is compared
    _hashed: ClassVar[attrgetter[Any]]
    _hash: int | None = None  # kept, or each node of a tree would be asked again and again

    def __init_subclass__(cls, *, kw_only: bool = False) -> None:
        own = fields(dataclass(init=False, repr=False, eq=False, kw_only=kw_only)(cls))
        cls._names = {each.name: None for each in own}.keys()
        for each in own:
            if each.default_factory is not MISSING:  # one for all, since records do not change
                setattr(cls, each.name, each.default_factory())
        cls._required = {each.name for each in own if not hasattr(cls, each.name)}
        compared = [each for each in own if each.compare]
        cls._key = attrgetter(*([each.name for each in compared] or ["__class__"]))
        hashed = (each.name for each in compared if each.hash is not False)
        cls._hashed = attrgetter("__class__", *hashed)
        cls._count = len(own) if len(own) == len(cls.__match_args__) else -1
        parameters = []
        for each in sorted(own, key=attrgetter("kw_only")):
            kind = Parameter.KEYWORD_ONLY if each.kw_only else Parameter.POSITIONAL_OR_KEYWORD
            default = getattr(cls, each.name, Parameter.empty)
            parameters.append(Parameter(each.name, kind, default=default, annotation=each.type))
        cls.__signature__ = Signature(parameters)

    def __init__(self, *values: Any, **named: Any) -> None:
        if named or len(values) != self._count:
            state = dict(zip(self.__match_args__, values, strict=False), **named)
            is_each_once = len(state) == len(values) + len(named)
            if not (is_each_once and self._required <= state.keys() <= self._names):
                kind, got = type(self).__name__, [*values, *named]
                raise TypeError(f"{kind} has the fields {[*self._names]}; got values for {got}")
            self.__dict__.update(state)  # the class has the defaults
        else:
            put = object.__setattr__
            for name, value in zip(self.__match_args__, values, strict=True):
                put(self, name, value)
        self.__post_init__()

    def __post_init__(self) -> None:
        """What a class checks of its fields."""

    def __setattr__(self, name: str, _: object = None) -> None:
        raise FrozenInstanceError(f"{type(self).__name__}.{name} is set once")

    __delattr__ = __setattr__

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return (self._key(self),) == (self._key(other),)  # as tuples, one NaN equals itself

    def __hash__(self) -> int:
        if self._hash is None:
            object.__setattr__(self, "_hash", hash(self._hashed(self)))
        return self._hash  # type: ignore[return-value]

    def __getstate__(self) -> dict[str, Any]:
        """Without the hash, which another process would not compute alike."""
        return {name: value for name, value in vars(self).items() if name != "_hash"}

    def __repr__(self) -> str:
        values = (f"{name}={getattr(self, name)!r}" for name in self._names)
        return f"{type(self).__name__}({', '.join(values)})"


if TYPE_CHECKING:
    from typing import NamedTuple as NamedTuple
else:

    class _TupleType(type):
        """Makes annotations the fields of a tuple, and what they are set to their defaults."""

        def __new__(cls, name, bases, body):
            fields = tuple(body.get("__annotations__", ()))
            defaults = {field: body[field] for field in fields if field in body}
            body |= {"__slots__": (), "_fields": fields, "_field_defaults": defaults}
            body |= {field: collections._tuplegetter(k, None) for k, field in enumerate(fields)}
            return super().__new__(cls, name, bases, {**body, "__match_args__": fields})

    class NamedTuple(tuple, metaclass=_TupleType):
        """As `typing.NamedTuple`."""

        def __new__(cls, *values, **named):
            lacking = len(cls._fields) - len(values)
            if named:
                own = dict(zip(cls._fields, values, strict=False), **named)
                state = {**cls._field_defaults, **own}
                is_each_once = len(own) == len(values) + len(named)
                lacking = 0 if is_each_once and state.keys() == {*cls._fields} else -1
                values = map(state.get, cls._fields)
            elif 0 < lacking <= len(cls._field_defaults):
                values += tuple(cls._field_defaults.values())[-lacking:]
                lacking = 0
            if lacking:
                raise TypeError(f"{cls.__name__} has the fields {cls._fields}; got {[*values]}")
            return tuple.__new__(cls, values)

        def __getnewargs__(self):
            return tuple(self)

        def __repr__(self):
            fields = (f"{field}={value!r}" for field, value in self._asdict().items())
            return f"{type(self).__name__}({', '.join(fields)})"

        def _asdict(self):
            return dict(zip(self._fields, self, strict=True))

        def _replace(self, **changes):
            changed = tuple.__new__(type(self), map(changes.pop, self._fields, self))
            if changes:
                raise TypeError(f"{type(self).__name__} has no fields {[*changes]}")
            return changed
