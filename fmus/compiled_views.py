"""Parameters and inputs as compiled code sees them: a place in memory, read where a field is used.

A NamedTuple of three hundred numbers passed by value is three hundred arguments, at every call. What a
step only reads is passed as a pointer instead: a field of a view is a number, or a view of its part. Where
a whole value is needed, in a constructor or beside another value, it is read whole.
"""

import operator
from collections.abc import Callable
from importlib import import_module
from typing import Any

numba: Any = import_module("numba")  # untyped on purpose: what it says of its types changes with every version
cgutils: Any = import_module("numba.core.cgutils")
extending: Any = import_module("numba.extending")
imputils: Any = import_module("numba.core.imputils")
templates: Any = import_module("numba.core.typing.templates")
conversion: Any = import_module("numba.core.typeconv")
types: Any = numba.types
POINTER = types.CPointer(types.float64)


class View(types.IterableType):  # type: ignore[misc]
    """A tuple, named or not, whose scalars lie in an array of doubles, as ``modelkit.variables`` orders them."""

    def __init__(self, whole: Any) -> None:
        self.whole = whole
        super().__init__(name=f"View({short(whole)})")

    @property
    def key(self) -> Any:
        """What tells two views apart."""
        return self.whole

    @property
    def iterator_type(self) -> Any:
        """The iterator over a tuple of equal items."""
        return ViewIterator(self)

    def can_convert_to(self, _typing: Any, other: Any) -> Any:
        """Say that a view is as good as what it shows."""
        return conversion.Conversion.safe if other == self.whole else None

    def unify(self, _typing: Any, other: Any) -> Any:
        """Return the value's type where a view meets a value."""
        return self.whole if other == self.whole or (isinstance(other, View) and other.whole == self.whole) else None


class ViewIterator(types.SimpleIteratorType):  # type: ignore[misc]
    """Goes through the items of a view of a tuple."""

    def __init__(self, view: View) -> None:
        self.view = view
        super().__init__(name=f"Iterator({view})", yield_type=seen(view.whole.types[0]))


def short(kind: Any) -> str:
    """Return a name without the types of all fields, which fill lines."""
    cls = getattr(kind, "instance_class", None)
    return cls.__name__ if cls else str(kind)


def value_type(kind: Any) -> Any:
    """Return the type of what ``kind`` shows if it is a view, else ``kind``."""
    return kind.whole if isinstance(kind, View) else kind


def seen(part: Any) -> Any:
    """Return the type of a field of type ``part`` when read from a view."""
    return View(part) if isinstance(part, types.BaseTuple) else part


def size(kind: Any) -> int:
    """Return the number of scalars in a value of type ``kind``."""
    return sum(size(part) for part in kind.types) if isinstance(kind, types.BaseTuple) else 1


def viewer(cls: type[Any]) -> Callable[..., Any]:
    """Return a function for compiled code from a pointer to doubles, or an array of them, to the view of a ``cls``."""
    view = View(numba.typeof(cls()))

    @extending.intrinsic  # type: ignore[untyped-decorator]
    def look(_typing: Any, scalars: Any) -> Any:
        def emit(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
            if isinstance(scalars, types.Array):
                return context.make_array(scalars)(context, builder, args[0]).data
            return args[0]

        return view(scalars), emit

    return look  # type: ignore[no-any-return]


def read(context: Any, builder: Any, kind: Any, pointer: Any, place: int = 0) -> Any:
    """Emit code for the value of type ``kind`` that begins ``place`` scalars behind ``pointer``."""
    if not isinstance(kind, types.BaseTuple):
        number = builder.load(_behind(context, builder, pointer, place))
        return context.cast(builder, number, types.float64, kind)
    items = []
    for part in kind.types:
        items.append(read(context, builder, part, pointer, place))
        place += size(part)
    return context.make_tuple(builder, kind, items)


def _behind(context: Any, builder: Any, pointer: Any, place: int) -> Any:
    return cgutils.gep_inbounds(builder, pointer, context.get_constant(types.intp, place)) if place else pointer


def _part(context: Any, builder: Any, view: View, pointer: Any, index: int) -> Any:
    """Emit code for item ``index`` of a view: a number, or the place where a view begins."""
    place = sum(size(part) for part in view.whole.types[:index])
    kind = view.whole.types[index]
    if isinstance(kind, types.BaseTuple):
        return _behind(context, builder, pointer, place)
    return read(context, builder, kind, pointer, place)


def _item(context: Any, builder: Any, view: View, pointer: Any, index: Any) -> Any:
    """Emit code for an item of a tuple of equal items, its ``index`` known at run time only."""
    kind = view.whole.types[0]
    stride = context.get_constant(types.intp, size(kind))
    place = cgutils.gep_inbounds(builder, pointer, builder.mul(index, stride))
    return place if isinstance(kind, types.BaseTuple) else read(context, builder, kind, place)


def install() -> None:
    """Teach numba both types; once in a process."""
    extending.register_model(View)(_ViewModel)
    extending.register_model(ViewIterator)(_IteratorModel)
    extending.infer_getattr(_ViewAttribute)
    templates.infer(_StaticItem)
    templates.infer_global(operator.getitem)(_Item)
    extending.overload(len)(_length)
    extending.lower_getattr_generic(View)(_lower_attribute)
    extending.lower_cast(View, types.BaseTuple)(_lower_cast)
    extending.lower_builtin("static_getitem", View, types.IntegerLiteral)(_lower_static_item)
    extending.lower_builtin(operator.getitem, View, types.Integer)(_lower_item)
    extending.lower_builtin("getiter", View)(_lower_iterator)
    extending.lower_builtin("iternext", ViewIterator)(imputils.iternext_impl(imputils.RefType.BORROWED)(_lower_next))


class _ViewModel(extending.models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, manager[POINTER].get_value_type())


class _IteratorModel(extending.models.StructModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, [("index", types.EphemeralPointer(types.intp)), ("view", kind.view)])


class _ViewAttribute(templates.AttributeTemplate):  # type: ignore[misc]
    key = View

    def generic_resolve(self, view: View, name: str) -> Any:
        fields = getattr(view.whole, "fields", ())
        return seen(view.whole.types[fields.index(name)]) if name in fields else None


class _StaticItem(templates.AbstractTemplate):  # type: ignore[misc]
    key = "static_getitem"

    def generic(self, args: Any, _kws: Any) -> Any:
        view, index = args
        if isinstance(view, View) and isinstance(index, int):
            return templates.signature(seen(view.whole.types[index]), *args)
        return None


class _Item(templates.AbstractTemplate):  # type: ignore[misc]
    key = operator.getitem

    def generic(self, args: Any, _kws: Any) -> Any:
        view, index = args
        if isinstance(view, View) and isinstance(index, types.Integer) and len(set(view.whole.types)) == 1:
            return templates.signature(seen(view.whole.types[0]), view, types.intp)
        return None


def _length(view):  # type: ignore[no-untyped-def]  # numba compares this signature with that of the result
    if not isinstance(view, View):
        return None
    count = len(view.whole.types)
    return lambda view: count


def _lower_attribute(context: Any, builder: Any, view: Any, pointer: Any, name: str) -> Any:
    return _part(context, builder, view, pointer, view.whole.fields.index(name))


def _lower_cast(context: Any, builder: Any, view: Any, whole: Any, pointer: Any) -> Any:
    value = read(context, builder, view.whole, pointer)
    return context.cast(builder, value, view.whole, whole)


def _lower_static_item(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    return _part(context, builder, signature.args[0], args[0], args[1] % len(signature.args[0].whole.types))


def _lower_item(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    return _item(context, builder, signature.args[0], *args)


def _lower_iterator(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    iterator = context.make_helper(builder, signature.return_type)
    iterator.index = cgutils.alloca_once_value(builder, context.get_constant(types.intp, 0))
    iterator.view = args[0]
    return iterator._getvalue()


def _lower_next(context: Any, builder: Any, signature: Any, args: Any, result: Any) -> None:
    iterator = context.make_helper(builder, signature.args[0], value=args[0])
    view = signature.args[0].view
    index = builder.load(iterator.index)
    valid = builder.icmp_signed("<", index, context.get_constant(types.intp, len(view.whole.types)))
    result.set_valid(valid)
    with builder.if_then(valid):
        result.yield_(_item(context, builder, view, iterator.view, index))
        builder.store(builder.add(index, context.get_constant(types.intp, 1)), iterator.index)
