"""Words that readers from the field do not know, and the terms to use: in prose, and in names of code."""

PROSE = {
    r"\bby lot\b": "at random, Monte Carlo, random seed",
    r"\bdownhill\b": "local search, CMA-ES",
    r"\bdrawn (anew|again|by)\b|\bfresh draws?\b": "sampled; independent sample",
    r"\b(is|are|was|were|been) heard\b|\blistened to\b": "detected, measured; processed",
    r"\bthe last word\b": "final verification",
    r"\bwho (comes?|drives?|walks|stands?|steps|moves?)\b": "moving obstacle, pedestrian, neighbouring vehicle",
    r"\bsomebody('s)?\b": "a third party, another supplier, a user",
    r"\bwhat is asked\b|\bis asked for\b": "requested, required",
    r"\bin thought\b": "simulated, predicted",
    r"\bgone without\b|\bstand in for it\b": "degraded operation, redundant sensor",
    r"\bthe way (driven|travelled)\b|\balong its way\b": "travelled distance, arc length",
    r"\bhow much of the way\b": "fraction of the path",
    r"\bastray\b|\baskew\b|\bcrooked\b": "deviation, misaligned",
    r"\bmended?\b": "fixed, repaired",
    r"\btold\b": "given, reported, displayed (say which)",
    r"\bthought to be\b|\bbelieved in\b|\bit thinks\b": "estimated, modelled",
    r"(?<!loading=.)\blazy\b": "lag",
    r"\bas mild as\b|\bmildest\b": "minimal counterexample",
    r"\bblunt(ly)?\b|\bodd ones?\b": "state what is meant",
    r"\bthe house('s)?\b|\bhouse limits\b": "project limits",
    r"\bsays? so\b|\bsays? it\b": "reports",
    r"\bcrash is ours\b": "terminates the command",
    r"\bon (the|its) way (in|out)\b": "entering, leaving the slot",
    r"\bthe clock on the wall\b": "real time",
}
"""Pattern -> term; in code, pages, scenarios and documentation."""
NAMES = {
    r"\bThing\b|\bthings?\b(?=[\.\[\(_])": "landmark, obstacle",
    r"\b\w*[Cc]omer\w*\b": "object track",
    r"\b\w*stir(s|red|ring)?\b(?!\w)": "motion",
    r"\b(is_)?told\w*\b": "external_slot, reported",
    r"\b\w*heard\w*\b": "detected, measured",
    r"\b(cone_|the_)?ear(s)?\b": "sensor pose, field of view",
    r"\b(SURE|TELLS|ODD|NEAR|MUCH|FEW|OFTEN|SOME|ENOUGH|LITTLE|SOON|LATE)\b": "a name that says what it limits",
    r"\b\w*_way\b|\bways?\b(?=[\.\[\(_,])": "path, distance, manoeuvre",
    r"\bunsure_of\b|\bsure_of\b|\bwider\b(?=\()|\bnearer\b(?=\()|\bcloser\b(?=\()": "sigma, inflate, tighten_margins",
    r"\bstrange\w*\b(?=[\.\[\(_ =])": "unexplained_echo",
    r"\bspared\b|\bdeaf\w*\b|\bmute\w*\b": "missed_echo, silent_sensor",
    r"\bby_lot\b|\blots?\b(?=[\.\[\(_])": "samples, random",
}
"""Pattern -> term; in Python outside the tests."""
PARTICIPLES = frozenset({
    "told", "heard", "known", "seen", "made", "done", "shown", "driven", "given", "taken", "left", "found", "kept",
    "learnt", "written", "chosen", "meant", "said", "drawn", "held", "begun", "gone", "sent", "lost", "wanted",
    "asked", "grown", "worn", "laid", "stood", "spared",
})  # fmt: skip
"""Irregular ones; words that end in ``ed`` come with them."""
NOUNS = frozenset({"need", "feed", "speed", "exceed", "shed", "red", "seed", "bed", "embed"})
"""End in ``ed`` and are none."""
RIDDLES = frozenset({
    "who", "what", "whose", "where", "how", "when", "whatever", "whoever", "no", "a", "an", "the", "in", "of", "from",
    "once", "nobody", "somebody", "it", "its",
})  # fmt: skip
"""First words after the area of a commit's subject that are no imperative."""
