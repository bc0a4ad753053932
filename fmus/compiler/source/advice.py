"""What to write instead of the constructs that have no place in model code."""

import ast

TABLE = "write a tuple of fixed length"
EXPRESSION_ADVICE: dict[type[ast.AST], tuple[str, str]] = {
    ast.List: ("a list", TABLE + ": (a, b, c)"),
    ast.ListComp: ("a list comprehension", "write tuple(f(x) for x in xs)"),
    ast.Dict: ("a dict", "write a NamedTuple, or a tuple indexed by an IntEnum"),
    ast.DictComp: ("a dict comprehension", "write a NamedTuple, or a tuple indexed by an IntEnum"),
    ast.Set: ("a set", "write x in (A, B)"),
    ast.SetComp: ("a set comprehension", "write x in (A, B)"),
    ast.GeneratorExp: ("a generator by itself", "write it inside tuple(), any(), all(), min(), max() or sum()"),
    ast.Lambda: ("a lambda", "write a function with def at the top of the module"),
    ast.JoinedStr: ("an f-string", "name what is meant by an IntEnum; text is made outside of the model"),
    ast.NamedExpr: (":= inside an expression", "bind the variable in a line of its own"),
    ast.Starred: ("a star", "write the items out, or join tuples with +"),
    ast.Await: ("await", "call the function directly"),
    ast.Yield: ("yield", "return a tuple of fixed length"),
    ast.YieldFrom: ("yield from", "return a tuple of fixed length"),
    ast.Slice: ("a slice", "write whole numbers: xs[1:4]"),
}
OUTSIDE = "keep model code to functions of its arguments; do this outside of the model"
STATEMENT_ADVICE: dict[type[ast.AST], tuple[str, str]] = {
    ast.Try: ("try", "test beforehand with if; a model gives a status, no exception"),
    ast.Raise: ("raise", "return a status in the result; a model gives no exception"),
    ast.Assert: ("assert", "test it with if and return a status, or check it in a test of the model"),
    ast.With: ("with", OUTSIDE),
    ast.Global: ("global", "pass the value in as an argument and return the new one"),
    ast.Nonlocal: ("nonlocal", "pass the value in as an argument and return the new one"),
    ast.FunctionDef: ("a function inside a function", "define it at the top of the module and pass what it needs"),
    ast.AsyncFunctionDef: ("async", "write a plain function"),
    ast.ClassDef: ("a class inside a function", "define the NamedTuple at the top of the module"),
    ast.Import: ("an import inside a function", "import at the top of the module"),
    ast.ImportFrom: ("an import inside a function", "import at the top of the module"),
    ast.Delete: ("del", "leave it out: a variable costs nothing"),
    ast.AsyncFor: ("async", "write a plain for"),
    ast.AsyncWith: ("async", OUTSIDE),
    ast.TryStar: ("try", "test beforehand with if; a model gives a status, no exception"),
}
CALL_ADVICE = {
    "print": "keep output outside of the model: put what is of interest into the outputs",
    "isinstance": "annotate the type: it is known",
    "list": "write a tuple of fixed length",
    "sorted": "sort outside of the model, or compare the items one by one",
    "reversed": "write range(n - 1, -1, -1)",
    "map": "write tuple(f(x) for x in xs)",
    "filter": "write a loop with if",
    "dict": "write a NamedTuple",
    "set": "write x in (A, B)",
    "str": "text is made outside of the model",
    "pow": "write x * x, math.sqrt(x) or math.exp(y * math.log(x))",
    "divmod": "write a // b and a % b",
    "input": "give the model an input",
    "open": "read files outside of the model, and give the model parameters",
    "getattr": "name the field",
    "hash": "it differs from run to run",
    "enumerate": "use it as what a for loop runs over",
    "zip": "use it as what a for loop runs over",
    "range": "use it as what a for loop runs over",
    "complex": "write the real and the imaginary part",
    "tuple": "write tuple(f(x) for x in xs); a tuple is one already",
    "sum": "write sum(f(x) for x in xs) of ints, or a loop that adds",
    "any": "write any(f(x) for x in xs)",
    "all": "write all(f(x) for x in xs)",
}
"""For Python's own functions."""
