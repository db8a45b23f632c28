"""Node parameters from one declarative table: a frozen dataclass whose fields are parameters.

The table gives type, default, description, range and whether a value may change at run time.
From it come the descriptors that ``ros2 param describe`` shows, the checks at start and at run
time, the help text, and a frozen object with the values::

    @dataclass(frozen=True)
    class Settings:
        rate: float = parameter(100.0, "Rate of joint_states", (1.0, 1000.0, "Hz"))

    settings = NodeParameters(node, Settings).settings

A name with dots, such as ``linear.x.max_velocity``, is a field ``linear__x__max_velocity``.
"""

import dataclasses
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic, TypeVar, get_args, get_type_hints

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

from robomech_ros.errors import RobomechError
from robomech_ros.errors.names import did_you_mean

Settings = TypeVar("Settings")

_METADATA = "robomech parameter"
_SHORTENED = 120
# Replaces the dot of a parameter's name in a field.
_DOT = "__"
_TEXTS = tuple[str, ...]
_TYPE_NAMES = {bool: "true or false", int: "an integer", float: "a number", str: "a string"}
# The wildcard and the parameters that rclpy itself declares.
_FOREIGN = ("use_sim_time", "start_type_description_service", "qos_overrides")
# Former names, and present ones.
_EARLIER = {
    "frame_age": "'max_transform_age'",
    "jog_silence": "'jog_timeout'",
    "largest_batch": "'max_batch_size'",
    "largest_count": "'max_samples'",
    "longest_lead": "'max_lead'",
    "longest_wait": "'max_queue_time'",
    "most_points": "'max_wrenches'",
}


class ParameterError(RobomechError):
    """A parameter was given a value that is not allowed."""

    def __init__(self, name: str, value: object, allowed: str) -> None:
        self.name = name
        self.value = value
        self.allowed = allowed
        shown = repr(value)
        if len(shown) > _SHORTENED:
            shown = shown[:_SHORTENED] + "..."
        super().__init__(f"parameter '{name}' is {shown}; allowed is {allowed}")


@dataclass(frozen=True)
class ParameterRow:
    """One row of the table.

    - ``low``, ``high``: allowed range, ends included.
    """

    name: str  #: Name of the parameter.
    kind: Any  #: bool, int, float, str, ``tuple[float, ...]`` or ``tuple[str, ...]``.
    default: Any  #: Default value.
    description: str  #: Meaning of the parameter, and of an empty value or zero.
    low: float | None = None
    high: float | None = None
    unit: str = ""  #: Unit, "" for none.
    choices: tuple[str, ...] = ()  #: Allowed strings; empty for any.
    read_only: bool = True  #: Whether it is fixed once the node runs.

    @property
    def field(self) -> str:
        """Name the field of the table."""
        return self.name.replace(".", _DOT)

    @property
    def allowed(self) -> str:
        """Describe the allowed values."""
        if self.choices:
            return "one of " + ", ".join(f"'{choice}'" for choice in self.choices)
        if self.kind == _TEXTS:
            return "a list of strings"
        numbers = self.kind not in _TYPE_NAMES
        text = "a list of numbers" if numbers else _TYPE_NAMES[self.kind]
        each = ", each" if numbers else ""
        unit = f" {self.unit}" if self.unit else ""
        low, high = (
            None if end is None else f"{int(end)}" if self.kind is int else f"{end:g}"
            for end in (self.low, self.high)
        )
        if low is None and high is None:
            return text + unit
        span = f"from {low} to {high}"
        if low is None or high is None:
            span = f"of at least {low}" if high is None else f"of at most {high}"
        return f"{text}{each} {span}{unit}"

    def checked(self, value: Any) -> Any:
        """Return the value in the type of the row; ParameterError if it is invalid."""
        if self.kind is float and type(value) is int:
            value = float(value)
        single = self.kind in _TYPE_NAMES
        if single:
            fits = type(value) is self.kind and self._allows(value)
        else:
            # An empty list comes as a list of bytes or as not set: it carries no type.
            listed = isinstance(value, Iterable | None) and not isinstance(value, str)
            fits = listed and all(map(self._allows, value or ()))
        if not fits:
            raise ParameterError(self.name, value, self.allowed)
        return value if single else tuple(map(get_args(self.kind)[0], value or ()))

    def _allows(self, value: Any) -> bool:
        """Return whether this may be the value, or an entry of the list."""
        if self.kind in (str, _TEXTS):
            return isinstance(value, str) and (not self.choices or value in self.choices)
        if self.kind is bool:
            return True
        if isinstance(value, bool | str | bytes):
            return False
        if math.isnan(value):
            # NaN stands for no value and switches off.
            return isinstance(self.default, float) and math.isnan(self.default)
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        return math.isfinite(value) and low <= value <= high

    def descriptor(self) -> ParameterDescriptor:
        """Make the descriptor for ``ros2 param describe``."""
        unit = f" [{self.unit}]" if self.unit else ""
        result = ParameterDescriptor(
            name=self.name, description=self.description + unit, read_only=self.read_only
        )
        if self.choices or self.kind not in _TYPE_NAMES:
            result.additional_constraints = self.allowed
        if self.low is None and self.high is None:
            return result
        if isinstance(self.default, float) and math.isnan(self.default):
            # No range of ROS contains the default.
            result.additional_constraints = f"{self.allowed}, or NaN"
            return result
        if self.kind is int:
            low = -(2**63) if self.low is None else int(self.low)
            high = 2**63 - 1 if self.high is None else int(self.high)
            result.integer_range = [IntegerRange(from_value=low, to_value=high)]
        elif self.kind is float:
            lowest = -sys.float_info.max if self.low is None else float(self.low)
            highest = sys.float_info.max if self.high is None else float(self.high)
            result.floating_point_range = [FloatingPointRange(from_value=lowest, to_value=highest)]
        return result


def parameter(
    default: Any,
    description: str,
    limits: tuple[Any, ...] = (),
    *,
    choices: tuple[str, ...] = (),
    read_only: bool = True,
) -> Any:
    """Make a field of a settings dataclass that is a parameter of the node.

    The arguments are those of `ParameterRow`, which takes name and type from the field; ``limits``
    holds the lowest and the highest value, either may be None, and the unit if there is one.
    """
    low, high, unit = (*limits, "")[:3] if limits else (None, None, "")
    row = ParameterRow("", None, default, description, low, high, unit, choices, read_only)
    return field(default=default, metadata={_METADATA: row})


# A parameter that may be set at run time.
changeable = partial(parameter, read_only=False)


def table_rows(table: type) -> tuple[ParameterRow, ...]:
    """List the parameters of a settings dataclass."""
    kinds = get_type_hints(table)
    return tuple(
        dataclasses.replace(
            entry.metadata[_METADATA], name=entry.name.replace(_DOT, "."), kind=kinds[entry.name]
        )
        for entry in dataclasses.fields(table)
    )


class NodeParameters(Generic[Settings]):
    """The declared parameters of a node.

    - ``node``: the node that declares the parameters.
    - ``table``: frozen dataclass whose fields come from :func:`parameter`.
    - ``on_change``: called with the new settings after a parameter changed at run time.
    - ``check``: called with the new settings before that; raises ParameterError to reject them.
    - ``former``: current names of parameters by other accepted names.
    - ``later``: prefix, without its dot, of the names of parameters that `declare` adds.

    Raises ParameterError: a value given at start is of the wrong type or out of range.
    """

    def __init__(
        self,
        node: Node,
        table: type[Settings],
        on_change: Callable[[Settings], None] | None = None,
        check: Callable[[Settings], None] = lambda settings: None,
        former: Mapping[str, str] | None = None,
        later: str = "",
    ) -> None:
        # Without the node: a reference cycle would keep it alive if it cannot start.
        self._former, self._later = {**_EARLIER, **(former or {})}, later
        #: Values of the parameters that `declare` has added, by name.
        self.further: dict[str, Any] = {}
        self._rows = {row.name: row for row in table_rows(table)}
        self._on_change = on_change
        self._check_settings = check
        #: The present values, an instance of the table.
        self.settings: Settings = table(
            **{r.field: _declared(node, r) for r in self._rows.values()}
        )
        self._warn_of_unknown(node, later=False)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._store)

    def declare(self, node: Node, rows: Iterable[ParameterRow]) -> None:
        """Declare parameters that become known later, such as those of joints.

        Raises ParameterError: a value given at start is of the wrong type or out of range.
        """
        for row in rows:
            self.further[row.name] = _declared(node, row)
            self._rows[row.name] = row
        self._warn_of_unknown(node, later=True)

    def _warn_of_unknown(self, node: Node, *, later: bool) -> None:
        """Warn of given parameters that the node does not have, with a hint for each."""
        for name in getattr(node, "_parameter_overrides", {}):
            head = name.split(".")[0]
            if name in self._rows or head in _FOREIGN or (head == self._later) is not later:
                continue
            hint = did_you_mean(name, self._rows)
            if name in self._former:
                hint = f": its name here is {self._former[name]}"
            node.get_logger().warning(f"unknown parameter '{name}' is ignored{hint}")

    def _check(self, changes: list[Parameter]) -> SetParametersResult:
        try:
            self._check_settings(self._changed(changes)[0])
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _store(self, changes: list[Parameter]) -> None:
        settings, further = self._changed(changes)
        if settings is not self.settings or further:
            self.settings = settings
            self.further |= further
            if self._on_change is not None:
                self._on_change(settings)

    def _changed(self, changes: list[Parameter]) -> tuple[Settings, dict[str, Any]]:
        """Return the settings with these changes, and the changes of further parameters.

        The settings are the same object if no change concerns them.
        """
        values = {
            change.name: self._rows[change.name].checked(change.value)
            for change in changes
            if change.name in self._rows
        }
        further = {name: values.pop(name) for name in self.further.keys() & values.keys()}
        if not values:
            return self.settings, further
        fields = {self._rows[name].field: value for name, value in values.items()}
        return dataclasses.replace(self.settings, **fields), further  # type: ignore[type-var]


def _declared(node: Node, row: ParameterRow) -> Any:
    # A first declaration without a type returns the given value, even an integer for a number.
    untyped = ParameterDescriptor(dynamic_typing=True)
    default = list(row.default) if isinstance(row.default, tuple) else row.default
    value = row.checked(node.declare_parameter(row.name, default, untyped).value)
    node.undeclare_parameter(row.name)
    if get_args(row.kind) and not value:
        kind = Parameter.Type.STRING_ARRAY if row.kind == _TEXTS else Parameter.Type.DOUBLE_ARRAY
        _declare_empty(node, row, kind)
    else:
        plain = list(value) if isinstance(value, tuple) else value
        node.declare_parameter(row.name, plain, row.descriptor(), ignore_override=True)
    return value


def _declare_empty(node: Node, row: ParameterRow, kind: Parameter.Type) -> None:
    """Declare a list without entries.

    rclpy takes a type from the first entry; a parameter with a type alone has no value, and whoever
    asks a node for several parameters gets none of them if one has no value.
    """
    node.declare_parameter(row.name, kind, ignore_override=True)
    node.set_parameters([Parameter(row.name, kind, [])])
    descriptor = row.descriptor()
    descriptor.type = kind.value
    node.set_descriptor(row.name, descriptor)
