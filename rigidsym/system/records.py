"""Immutable records and named tuples, for whose classes little is compiled.

`dataclass` compiles six functions for a class, in 0.7 ms, and `typing.NamedTuple` the annotation of
each field, in 0.1 ms. A start loads a hundred of both.
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Set
from dataclasses import Field, FrozenInstanceError, dataclass, field, fields
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
    _hash: int | None = None  # kept, or each node of a tree would be asked again and again

    def __init_subclass__(cls, *, kw_only: bool = False) -> None:
        own = fields(dataclass(init=False, repr=False, eq=False, kw_only=kw_only)(cls))
        for each in own:
            if callable(each.default_factory):  # one for all, since records do not change
                setattr(cls, each.name, each.default_factory())
        cls._names = {each.name: None for each in own}.keys()
        cls._required = {name for name in cls._names if not hasattr(cls, name)}
        cls._key = attrgetter(*([each.name for each in own if each.compare] or ["__class__"]))
        cls._count = len(own) if len(own) == len(cls.__match_args__) else -1
        parameters = []
        for each in sorted(own, key=attrgetter("kw_only")):
            kind = Parameter.KEYWORD_ONLY if each.kw_only else Parameter.POSITIONAL_OR_KEYWORD
            default = getattr(cls, each.name, Parameter.empty)
            parameters.append(Parameter(each.name, kind, default=default, annotation=each.type))
        cls.__signature__ = Signature(parameters)

    def __init__(self, *values: Any, **named: Any) -> None:
        state = self.__dict__  # the class has the defaults
        state.update(zip(self.__match_args__, values, strict=False), **named)
        if named or len(values) != self._count:
            is_each_once = len(state) == len(values) + len(named)
            if not (is_each_once and self._required <= state.keys() <= self._names):
                kind, got = type(self).__name__, [*values, *named]
                raise TypeError(f"{kind} has the fields {[*self._names]}; got values for {got}")
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
            object.__setattr__(self, "_hash", hash(self._key(self)))
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
        """`typing.NamedTuple`, which does not compile annotations."""

        def __new__(cls, name, _, body):
            types = body.get("__annotations__", {})
            defaults = [body.pop(field) for field in types if field in body]
            made = namedtuple(name, types, defaults=defaults, module=body["__module__"])
            for key, value in body.items():  # Python refuses a body with super() in a method
                setattr(made, key, value)
            return made

    NamedTuple = type.__new__(_TupleType, "NamedTuple", (), {})
