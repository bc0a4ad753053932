"""From a model's Python to one readable C99 file and its header. Knows no FMI.

    translation = translate(model)        # .name, .header, .source
    members(model)                        # where each flat variable is in the C structs

What cannot be proved equal in C is refused (``UnsupportedError``) with its place and what to write instead.
"""

from fmus.compiler.source.diagnostics import Diagnostic, UnsupportedError
from fmus.compiler.target.members import Member, member_path, members
from fmus.compiler.translation import Translation, live_inputs, translate

__all__ = [
    "Diagnostic",
    "Member",
    "Translation",
    "UnsupportedError",
    "live_inputs",
    "member_path",
    "members",
    "translate",
]
