"""Force laws of PTOs and other components along a coordinate: one law, one file.

Sign, the same for all: F is the generalised force on the coordinate s. Positive F drives s up: along a joint it pushes
(or turns) a in the positive sense of the coordinate and b the other way, between two points it pushes them apart.
So a spring and damper is F = -k s - c v, v = ds/dt, as in WEC-Sim, and the absorbed power is P = -F v.

A law is a description with `group()`: the class that evaluates all laws of its kind at once,

    Group(laws, which, labels)      which: coordinate of each law; labels: name of its PTO, for messages
    add(now, F) -> str | None       adds force and derivatives by s and v to F (3, n) of the coordinates; the sentence
                                    is why the step cannot be accepted. now (`Now`): time, step, s, v, memory
    signals() -> [(law, suffix, long name, units)], tell(now) -> values      optional: what else it has to tell
    error(now) -> float                                                  optional: local error over what is allowed
    start(t, s) -> array, commit(now) -> bool                            optional: its memory; True: the force jumps

and for the energy ledger, if it has them: `potential(s)`, (energy, force) of its spring; `dry(v)`, force of friction.
"""
