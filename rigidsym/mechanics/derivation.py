"""A derivation is data: quantities, the steps that lead to them, and a proof beside each step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, Self

import sympy as sp

from rigidsym.algebra.zeros import Place as Place
from rigidsym.errors import QuantityError, TemplateFault, offer
from rigidsym.formula.reader import Sentence, formula, named
from rigidsym.formula.tree import NOTHING, Formula, with_names
from rigidsym.models.rotation import Citation, RotationModel
from rigidsym.system.records import NamedTuple, Record

if TYPE_CHECKING:
    from rigidsym.models.body import RigidBody
    from rigidsym.models.forces import Forces

Status = Literal["exact", "unproved"]
OF_RATES = "rates"  # the section of the quantities that the singularities are about


def phrases(file: str) -> Mapping[str, Any]:
    """The sentences of a file of templates/notes/en by their keys."""
    # imported by whatever prints a note, but not by a derivation that nobody prints
    from rigidsym.system.resources import sentences

    return sentences(f"en/{file}.toml")


def phrase(file: str, key: str) -> str:
    """One sentence of a file; raises TemplateFault, with the nearest key, if there is none."""
    sentences = phrases(file)
    if key not in sentences:
        raise TemplateFault(f"templates/notes/en/{file}.toml: no {key!r}; {offer(key, sentences)}")
    return str(sentences[key])


def sentence_of(reason: str) -> str:
    """The sentence of a reason by its key; nothing for no reason."""
    return phrase("reasons", reason) if reason else ""


def remark(key: str, **values: Any) -> str:
    """A remark on a result, for a terminal, with its values."""
    return phrase("remarks", key).format(**values)


class Proof(Record, kw_only=True):
    """One claim and the result of its proof.

    *exact*: the residual reduces to zero in the ring. *unproved*: the residual does not reduce to
    zero, but the ring does not contain all relations, so that the claim is undecided.
    """

    claim: Formula  # R Rᵀ = 1
    status: Status
    residual: sp.ImmutableMatrix | None = None  # None if it is zero

    @property
    def is_exact(self) -> bool:
        return self.status == "exact"

    def in_letters(self, letters: Mapping[Formula, Formula]) -> Self:
        """The proof with other letters in its claim."""
        return replace(self, claim=with_names(self.claim, letters))


Shape = Literal["scalar", "vector", "matrix"]  # (), (n,) and (m, n) in kernels and JSON


class Frame(NamedTuple):
    """The axes that components are along, with the letters of the angular velocity in them."""

    name: str  # "space" or "body"
    prime: str  # on letters: "" or "'"
    omega: Formula
    matrix: Formula  # W, with Ω = W q̇
    inverse: Formula
    right_inverse: Formula  # if there are more coordinates than dimensions


class Law(NamedTuple):
    """A claim about a quantity, and what vanishes if it holds.

    The residual for a value x is worked out in a workspace k: a `RingMatrix`, also with a divisor;
    a SymPy matrix is a rational function of the constants of a body. None is claimed if it is None.
    """

    claim: Formula  # R Rᵀ = 1
    residual: Callable[[Any, Any], Any]


def law(claim: str, residual: Callable[[Any, Any], Any], *parts: Formula) -> Law:
    """The law with a claim that is typed as `formula` reads it."""
    return Law(formula(claim, *parts), residual)


class Quantity(NamedTuple):
    """A quantity: its one entry among the `quantities`, and how a step presents it.

    The value and the residuals of the laws are functions of a workspace k. `variants` say what
    differs for models with certain traits: "passive", "chain", ... (`Values.traits`).
    """

    symbol: Formula
    name: str = ""  # in Python, in kernels, in JSON: that of its entry
    meaning: str = ""  # its words, a key of templates/notes/en/quantities.toml; by default the name
    by: str = ""  # of a Jacobian, the vector that the quantity is differentiated by
    unit: str = ""  # SI, "" for a pure number
    unit_of: str = ""  # the argument that it is a value of, whose unit it has
    inputs: tuple[str, ...] = ()  # the arguments it depends on, by name: "q", "q_dot", ...
    shape: Shape = "matrix"  # the expression of a vector is n x 1, that of a scalar 1 x 1
    frame: Frame | None = None  # of its components
    # which of "rows" and "columns" are components along axes, and turn with them; None: not stated
    axes: tuple[str, ...] | None = None
    definition: Formula = NOTHING  # how it follows: C⁻¹(dR/dt Rᵀ)
    source: Citation | None = None
    # a matrix, over a ring or as it is printed, or (matrix, divisor); None if a model has none
    value: Callable[[Any], Any] | None = None
    rests_on: Callable[[Any], Sequence[Proof]] | None = None  # proofs of what it is worked out from
    laws: tuple[Law, ...] = ()
    also: tuple[str, ...] = ()  # quantities that the value is written with; their laws count, too
    reason: str = ""  # how it follows, a key of templates/notes/en/reasons.toml
    words: Callable[[Any], str] | None = None  # a sentence made of several reasons
    without: str = ""  # why a model may not have it, a key of templates/notes/en/reasons.toml
    vectors: str = ""  # which form it has by a vector of coordinates: "rotation", "velocity", ...
    recursion: str = ""  # over the turns of a chain, in TeX; LAST is the number of turns
    section: str = ""  # of the note
    is_result: bool = False  # whether it is framed in the note
    variants: tuple[tuple[frozenset[str], Mapping[str, Any]], ...] = ()

    @property
    def about(self) -> str:
        """Words: "angular velocity, space components", "Jacobian with respect to q of ..."."""
        words = phrase("quantities", self.meaning or self.name)
        return f"Jacobian with respect to {self.by} of {words}" if self.by else words

    def presented(self, traits: Set[str]) -> Quantity:
        """The quantity as it is for a model with these traits; later variants take precedence."""
        changes: dict[str, Any] = {}
        for needed, change in self.variants:
            if needed <= traits:
                changes |= change
        return self._replace(**changes) if changes else self

    def __reduce__(self) -> tuple[Any, ...]:
        """Without its functions, which another process has no use for."""
        plain = self._replace(value=None, rests_on=None, words=None)
        return Quantity, tuple(plain._replace(laws=(), also=(), variants=()))


def when(*traits: str, **changes: Any) -> tuple[frozenset[str], Mapping[str, Any]]:
    """A variant of a quantity."""
    return frozenset(traits), changes


def by_name(module: dict[str, Any]) -> Mapping[str, Quantity]:
    """The quantities of a module, which get their names in it, in the order of the derivation."""
    found = {n: q._replace(name=n) for n, q in module.items() if isinstance(q, Quantity)}
    module.update(found)
    return MappingProxyType(found)


class Argument(NamedTuple):
    """A vector of inputs, (n,): the coordinates, their rates, an angular velocity."""

    name: str  # "q"
    symbols: tuple[sp.Expr, ...]  # the SymPy expressions the components stand for
    names: tuple[str, ...]  # plain names of the components: "phi_dot"
    notation: tuple[Formula, ...]  # how a component is printed
    units: tuple[str, ...]  # a unit a component
    is_scalar: bool = False  # one number, of shape ()
    meaning: str = ""  # its words, a key of templates/notes/en/quantities.toml; by default the name
    words: str = ""  # in place of these

    @property
    def about(self) -> str:
        """Words: "coordinates", "space components of the angular velocity"."""
        return self.words or phrase("quantities", self.meaning or self.name)


def argument(
    name: str,
    symbols: Sequence[sp.Expr],
    *,
    meaning: str = "",
    words: str = "",
    units: str | Sequence[str] = "",
    names: Sequence[str] = (),
    notation: Sequence[Formula] = (),
) -> Argument:
    """An argument; its components are called and printed by their symbols unless said otherwise."""
    names = tuple(names or map(str, symbols))
    return Argument(
        name=name,
        symbols=tuple(symbols),
        names=names,
        notation=tuple(notation or map(named, names)),
        units=(units,) * len(names) if isinstance(units, str) else tuple(units),
        meaning=meaning,
        words=words,
    )


class VectorTerm(NamedTuple):
    """coefficient · vector."""

    coefficient: sp.Expr
    vector: Formula  # v̇, v × v̇, ...


class VectorForm(NamedTuple):
    """A vector quantity in terms of the vector v of the coordinates, proved equal to it."""

    terms: tuple[VectorTerm, ...]
    components: tuple[sp.Expr, ...]  # of v, which coordinates they are
    length: sp.Symbol  # stands for |v| in the coefficients
    proof: Proof
    last: VectorTerm | None = None  # the last row, of a coordinate that is not in v


class FirstIntegral(NamedTuple):
    """A quantity that is constant along every motion, with the proof that it is."""

    name: str  # "energy", "momentum_phi"
    symbol: Formula  # E, p_φ
    expression: sp.Expr  # in the coordinates and their rates
    proof: Proof


class Consequence(NamedTuple):
    """An equation that follows from the equations of motion."""

    name: str  # of its sentences, a macro of templates/notes/en/consequences.md.jinja
    spans: Mapping[str, Any]  # formulas, expressions and words in these sentences
    left: Formula | sp.Expr
    value: Formula | sp.Expr
    proofs: tuple[Proof, ...] = ()
    where: tuple[tuple[Formula | sp.Expr, sp.Expr], ...] = ()  # symbols of it with their values


class Definition(NamedTuple):
    """A named intermediate quantity: symbol = expression, in inputs and names defined before it."""

    symbol: sp.Symbol
    expression: sp.Expr


def needed_of(
    definitions: Sequence[Definition], symbols: Set[sp.Basic], defined: Set[sp.Basic] = frozenset()
) -> list[Definition]:
    """The definitions that symbols rest on, in their order, without those `defined`."""
    needed = {*symbols}
    # A definition rests only on earlier ones, so one pass from the last to the first finds all.
    for symbol, value in reversed(definitions):
        if symbol in needed:
            needed |= value.free_symbols - defined
    return [part for part in definitions if part.symbol in needed]


class Step(Record, kw_only=True):
    """One quantity, derived: its textbook form, how it follows, and what was proved of it."""

    quantity: Quantity
    expression: sp.ImmutableMatrix
    proofs: tuple[Proof, ...] = ()
    number: int = 0  # of its equation, in the note and in the docstrings of kernels; 0 for none
    vector_form: VectorForm | None = None  # where the coordinates form a vector
    recursion: Formula | None = None  # shown for the entries, if these are names of its parts
    words: str = ""  # a sentence in place of that of the quantity's reason
    # The same entries in another order, and the names that replaced those of their components.
    original: tuple[sp.ImmutableMatrix, Mapping[sp.Basic, sp.Basic]] | None = None

    def __repr__(self) -> str:
        """One line, for a prompt; `Motion.text` shows the equation."""
        proved = all(proof.is_exact for proof in self.proofs)
        return f"<Step {self.quantity.name}, {'proved' if proved else 'not proved'}>"

    @property
    def because(self) -> str:
        """A sentence: how the quantity follows from the steps before."""
        return self.words or sentence_of(self.quantity.reason)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Shape of one value in kernels and JSON."""
        rows, columns = self.expression.shape
        return {"scalar": (), "vector": (rows,), "matrix": (rows, columns)}[self.quantity.shape]


class Statement(NamedTuple):
    """One equation of the theory, for every body and every rotation."""

    name: str
    number: int | None  # in the lecture; None for what it leaves without one
    section: str  # the heading that it stands under
    because: Sentence  # how it follows from those before
    sides: tuple[Formula, ...]  # of the equation
    claims: tuple[tuple[str, Formula], ...]  # what is to be proved, by name
    source: Citation
    proofs: tuple[Proof, ...] = ()
    is_result: bool = False  # whether it is framed in the note
    summands: sp.ImmutableMatrix | None = (
        None  # of the generic particle; their sum is the last side
    )


class Singularity(Record, kw_only=True):
    """An orientation at which the rate matrix loses rank, and what is lost there.

    Only rates that satisfy the conditions on the coordinates count.
    """

    places: tuple[Place, ...]  # all at once; none if the rank is too low everywhere
    rank: int
    lost_axis_space: sp.ImmutableMatrix | None  # no q̇ gives Ω along this direction; (3, 1)
    lost_axis_body: sp.ImmutableMatrix | None  # its line in body components
    null_rates: sp.ImmutableMatrix  # columns that span the q̇ with Ω = 0, (n, k)
    reachable_axis: sp.ImmutableMatrix | None = None  # of all Ω, if the rank is 1; (3, 1)


Measure = Literal["det W", "det [W, J]", "det W Wᵀ", "det Wᵀ W", "minors"]


class Singularities(NamedTuple):
    """Orientations at which the rate matrix has less than its generic rank.

    That is where the determinant vanishes: of W, where it is square; of W Wᵀ or Wᵀ W, where it is
    wide or tall, which is the sum of the squares of the minors; of W above the rows J = ∂c/∂q of
    the conditions c = 0, where these make a square of it. The points are where all minors vanish.
    """

    rank: int  # of W at generic coordinates
    measure: Measure
    determinant: sp.Expr | None  # None if there is no divisor, and hence no failure
    minors: tuple[sp.Expr, ...]  # the determinant itself, or minors whose squares add up to it
    points: tuple[Singularity, ...]
    is_solved: bool  # whether `points` are all the places where the rank falls

    @property
    def length(self) -> sp.Expr | None:
        """What takes the place of an angle at the points; never at 0."""
        places = (place for point in self.points for place in point.places)
        return next((place.coordinate for place in places if place.is_length), None)


class Derivation(Record, kw_only=True):
    """An ordered tuple of steps from one rotation model; every quantity is an attribute too."""

    name: str
    title: str
    model: RotationModel
    arguments: tuple[Argument, ...]
    steps: tuple[Step, ...]
    singularities: Singularities | None  # None if no quantity of the rates was asked for
    body: RigidBody | None = None  # what turns, where energy and momentum were asked for
    theory: tuple[Statement, ...] = ()  # the equations that the steps rest on, where asked for
    definitions: tuple[Definition, ...] = ()  # intermediate quantities that the steps name
    first_integrals: tuple[FirstIntegral, ...] = ()  # where equations of motion were asked for
    consequences: tuple[Consequence, ...] = ()  # of the equations of motion
    forces: Forces | None = None  # where equations of motion were asked for
    about_fixed_point: bool = False  # whether the tensor is about it, not the centre of mass
    functions: Mapping[str, Step] = field(default_factory=dict)  # for kernels: they repeat parts

    def step(self, quantity: str) -> Step:
        """The step that defines a quantity; raises QuantityError for one that is not here."""
        steps = {**{step.quantity.name: step for step in self.steps}, **self.functions}
        if quantity in steps:
            return steps[quantity]
        near = offer(quantity, steps, listed=True)
        raise QuantityError(f"{self.name} has no quantity {quantity!r}; {near}")

    def select(self, names: Sequence[str]) -> Self:
        """The derivation with only these quantities, renumbered in the order of the steps.

        Singularities belong to the rates. Raises QuantityError for a name that is not here.
        """
        quantities = [self.step(name).quantity for name in names]
        chosen = {quantity.name for quantity in quantities}
        kept = [step for step in self.steps if step.quantity.name in chosen]
        numbered = tuple(replace(step, number=place) for place, step in enumerate(kept, start=1))
        has_rates = any(quantity.section == OF_RATES for quantity in quantities)
        kept_singularities = self.singularities if has_rates else None
        return replace(self, steps=numbered, singularities=kept_singularities)

    def spelled(self, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
        """The matrix in terms of inputs only, after named quantities are substituted."""
        values: dict[sp.Symbol, sp.Expr] = {}
        for definition in self.definitions:
            values[definition.symbol] = definition.expression.xreplace(values)
        return matrix.xreplace(values) if values else matrix

    def definitions_in(self, expression: sp.Basic, defined: Set[sp.Basic]) -> list[Definition]:
        """The definitions that an expression rests on, in their order, without those `defined`."""
        symbols = expression.free_symbols - defined if self.definitions else frozenset()
        return needed_of(self.definitions, symbols, defined)

    @property
    def subject(self) -> str:
        """What the derivation is about, in words."""
        kind = "motion" if self.body else "kinematics"
        return phrase("quantities", "equations_of_lecture" if self.theory else kind)

    def argument(self, name: str) -> Argument:
        return next(argument for argument in self.arguments if argument.name == name)

    @property
    def proofs(self) -> Iterator[Proof]:
        yield from (proof for statement in self.theory for proof in statement.proofs)
        yield from (proof for step in self.steps for proof in step.proofs)
        yield from (integral.proof for integral in self.first_integrals)
        yield from (proof for found in self.consequences for proof in found.proofs)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name in ("steps", "functions"):  # before there are any
            raise AttributeError(name)
        if name in self.functions or any(step.quantity.name == name for step in self.steps):
            step = self.step(name)
            value = self.spelled(step.expression)
            return value[0] if step.quantity.shape == "scalar" else value
        own = f"{type(self).__name__} {self.name!r} has no quantity {name!r}"
        near = offer(name, [known for known in dir(self) if not known.startswith("_")])
        raise AttributeError(f"{own}; {near}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(step.quantity.name for step in self.steps)})
