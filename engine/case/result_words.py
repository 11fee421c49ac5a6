"""Words that stand in results, beside numbers or in their place.

Each is a `StrEnum`: a member is written, compared, sorted and pickled as the word itself.
"""

from __future__ import annotations

from enum import StrEnum


class Judgement(StrEnum):
    """The verdict of a check."""

    PASS = "pass"
    #: Within the limit, but by less than the error of the result.
    WITHIN_ERROR = "pass within its error"
    ACCEPTED = "accepted by forced response"
    FAIL = "fail"
    UNBOUNDED = "unbounded"
    #: What was judged is within its limits, but a part was not judged.
    INCOMPLETE = "incomplete"
    NOT_JUDGED = "not judged"
    #: Of a whole calculation: a result that no train has, so there is no verdict.
    CHECK_INPUTS = "check the inputs"


#: Overall verdicts that a train may be accepted by.
ACCEPTABLE = frozenset({Judgement.ACCEPTED, Judgement.PASS})


class NoNumber(StrEnum):
    """What stands where a number would."""

    UNLIMITED = "unlimited"
    UNBOUNDED = "unbounded"
    NOT_JUDGED = "not judged"


class Outcome(StrEnum):
    """The word for how a start ended, with the sentence that its numbers are filled into."""

    sentence: str

    def __new__(cls, word: str, sentence: str) -> Outcome:
        """A member with its sentence."""
        member = str.__new__(cls, word)
        member._value_ = word
        member.sentence = sentence
        return member

    #: It came to its end speed.
    REACHED = "reached", "{share:.1%} speed ({rpm:.1f} rpm) reached after {end:.3f} s."
    #: With the field applied it came into step.
    SYNCHRONISED = (
        "synchronised",
        "Synchronised: {applied}; {slips}, {in_step}, load angle {load_angle:.1f} degrees{swing}.",
    )
    #: With the field applied it went on slipping poles, or the run ended first.
    NOT_SYNCHRONISED = (
        "not synchronised",
        "Not synchronised: {applied}; {pole_slips} pole slips until {end:.3f} s, when the train "
        "turned at {share:.2%} speed.",
    )
    #: An aborted start came to its trip speed and coasted down.
    TRIPPED = (
        "tripped",
        "Tripped at {trip_share:.1%} speed after {trip_time:.3f} s; coasted down to {share:.1%} "
        "speed ({rpm:.1f} rpm) until {end:.3f} s.",
    )
    #: Torque and load balance close below synchronous speed.
    ASYNCHRONOUS = (
        "asynchronous",
        "Asynchronous: torque and load balance at {rpm:.1f} rpm ({share:.1%} speed), below the end "
        "speed of {end_share:.1%}.",
    )
    #: They balance at a lower speed.
    STALLED = (
        "stalled",
        "Stalled: torque and load balance at {rpm:.1f} rpm ({share:.1%} speed), below the end speed "
        "of {end_share:.1%}.",
    )
    #: The motor cannot turn the train at all.
    NO_BREAKAWAY = (
        "no breakaway",
        "No breakaway: at standstill the loads take {load:.4g} N m, the motor gives {average:.4g} "
        "N m (referred to the motor).",
    )
    #: The run ended before the start did.
    TIME_OUT = "time out", "Time out: {rpm:.1f} rpm ({share:.1%} speed) after {end:.3f} s."
    #: Prescribed torques were followed to their end; there is no start.
    COMPLETED = "completed", "Prescribed torques followed to {end:.4g} s."
