"""Data classes with a late ``__init__`` behave as those of the standard library."""

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, InitVar, field
from typing import Any, ClassVar

import pytest

from vehicledyn.base.lazy_data import dataclass


def _made(decorator: Any) -> dict[str, Any]:
    """Return classes of each kind, declared by a decorator."""

    @decorator(frozen=True)
    class Frozen:
        """A class whose defaults, hidden and uncompared fields differ."""

        count: ClassVar[int] = 3
        self: float
        second: Any = field(default=2, compare=False)
        third: Any = field(default_factory=lambda: [1], hash=False)
        fourth: Any = field(default=4, repr=False, kw_only=True)

        def __post_init__(self_) -> None:  # noqa: N805
            if self_.self < 0:
                raise ValueError("below zero")

    @decorator(frozen=True)
    class Derived(Frozen):
        """A class with a frozen base and one field more."""

        second: Any = 7
        fifth: Any = "five"

    @decorator
    class Open:
        """A class whose objects change."""

        first: list[int]
        second: dict[str, int] = field(default_factory=dict)
        third: Any = field(default_factory=list, init=False)
        fourth: Any = field(default=5, init=False)

    @decorator(frozen=True, kw_only=True)
    class Named:
        """A class whose fields are named."""

        first: int = 1
        second: int

    @decorator(frozen=True, eq=False)
    class Same:
        """A class whose objects are equal to themselves only."""

        first: int

    @decorator(frozen=True, repr=False)
    class Own:  # noqa: PLW1641
        """A class with methods of its own."""

        first: int

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Own)

        def __repr__(self) -> str:
            return "own"

    @decorator
    class OwnHash:
        """A class that keeps its hash."""

        first: int = 0

        def __hash__(self) -> int:
            return 7

    @decorator(frozen=True)
    class Empty:
        """A class without fields."""

    @decorator(frozen=True)
    class Bare:
        first: int = 1

    @decorator
    class Started:
        """A class with a value for its start only."""

        first: int
        factor: InitVar[int] = 2

        def __post_init__(self, factor: int) -> None:
            self.first *= factor

    return {name: entry for name, entry in locals().items() if isinstance(entry, type)}


OURS, THEIRS = _made(dataclass), _made(dataclasses.dataclass)
CALLS: dict[str, list[tuple[tuple[Any, ...], dict[str, Any]]]] = {
    "Frozen": [((1.0,), {}), ((1.0, 9), {}), ((2.0,), {"fourth": 1}), ((-1.0,), {}), ((), {})],
    "Derived": [((1.0,), {}), ((1.0, 2, [3], "x"), {"fourth": 0}), ((1.0,), {"sixth": 1})],
    "Open": [(([1],), {}), (([1], {"a": 1}), {}), (([2], {}, 3), {}), ((), {})],
    "Named": [((), {"second": 2}), ((), {"first": 3, "second": 2}), ((1,), {"second": 2})],
    "Same": [((1,), {}), ((1,), {})],
    "Own": [((1,), {}), ((2,), {})],
    "OwnHash": [((), {}), ((1,), {})],
    "Empty": [((), {}), ((1,), {})],
    "Bare": [((), {}), ((2,), {})],
    "Started": [((2,), {}), ((2, 3), {})],
}


def _objects(entry: Any) -> list[Any]:
    made: list[Any] = []
    for arguments, named in CALLS[entry.__name__]:
        try:
            made.append(entry(*arguments, **named))
        except (TypeError, ValueError) as error:
            made.append(str(error))
    return made


def _answer(ask: Any) -> str:
    try:
        return str(ask())
    except (TypeError, AttributeError) as error:
        return f"{type(error).__name__}: {error}"


@pytest.mark.parametrize("name", CALLS)
def test_same_as_standard_library(name: str) -> None:
    ours, theirs = OURS[name], THEIRS[name]
    assert _objects(ours) != []
    for mine, other in zip(_objects(ours), _objects(theirs), strict=True):
        assert repr(mine) == repr(other).replace("Own object", "Own")
        if isinstance(mine, str):
            continue
        assert vars(mine) == vars(other)
        if ours.__eq__ is not object.__eq__:
            assert _answer(lambda mine=mine: hash(mine)) == _answer(lambda other=other: hash(other))
            assert mine == copy.copy(mine)
        assert _answer(lambda mine=mine: setattr(mine, "first", 3)) == _answer(
            lambda other=other: setattr(other, "first", 3)
        )
        assert _answer(lambda mine=mine: delattr(mine, "second")) == _answer(
            lambda other=other: delattr(other, "second")
        )
    pairs = [
        [(a == b) for a in _objects(entry) for b in _objects(entry)] for entry in (ours, theirs)
    ]
    assert pairs[0] == pairs[1]
    assert str(inspect.signature(ours)) == str(inspect.signature(theirs))
    assert ours.__match_args__ == theirs.__match_args__
    assert (ours.__hash__ is None) == (theirs.__hash__ is None)
    assert ours.__doc__ == theirs.__doc__
    assert ours.__init__.__qualname__ == theirs.__init__.__qualname__
    assert str(ours.__init__.__annotations__) == str(theirs.__init__.__annotations__)
    assert repr(ours.__dataclass_params__) == repr(theirs.__dataclass_params__)


@dataclass(frozen=True)
class Kept:
    """A class that can be found by its name."""

    first: int
    second: tuple[int, ...] = ()


def test_methods_are_written_late_and_once() -> None:
    class Base:
        """Says nothing."""

    @dataclass
    class Late(Base):
        """Not asked for yet."""

        first: int

    waiting = Late.__dict__["__init__"]
    assert not inspect.isfunction(waiting)
    assert Late(1).first == 1
    assert inspect.isfunction(Late.__dict__["__init__"])
    assert waiting.__get__(None, Late) is Late.__init__


def test_objects_are_copied_and_kept() -> None:
    item = Kept(1, (2,))
    assert pickle.loads(pickle.dumps(item)) == item == copy.deepcopy(item)
    assert dataclasses.replace(item, first=3) == Kept(3, (2,))
    assert dataclasses.asdict(item) == {"first": 1, "second": (2,)}


def test_standard_subclass_of_a_late_class() -> None:
    @dataclasses.dataclass(frozen=True)
    class Wider(Kept):
        """A class of a user."""

        third: int = 3

    assert Wider(1) == Wider(1, (), 3)
    with pytest.raises(FrozenInstanceError):
        Wider(1).third = 4  # type: ignore[misc]
    with pytest.raises(TypeError, match="cannot inherit non-frozen"):
        dataclass(type("Changing", (Kept,), {"__doc__": "Refused."}))


def test_faulty_declarations_are_refused() -> None:
    with pytest.raises(TypeError, match="'second' follows default argument"):

        @dataclass
        class Wrong:
            """A field without default after one with."""

            first: int = 1
            second: int

    open_class = dataclass(type("Open", (), {"__doc__": "Changes."}))
    with pytest.raises(TypeError, match="cannot inherit frozen"):
        dataclass(frozen=True)(type("Frozen", (open_class,), {"__doc__": "Does not."}))
    with pytest.raises(TypeError, match="Cannot overwrite attribute __setattr__"):
        dataclass(frozen=True)(type("Own", (), {"__doc__": "Own.", "__setattr__": print}))
