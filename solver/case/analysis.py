"""What is asked of a case: statics, frequency domain, time domain, modes, each with its parameters."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from .quantities import Frequency, NonNegativeFrequency, NonNegativeTime, Part, Time

Iterations = Annotated[int, Field(ge=1, le=10_000)]


class Statics(Part):
    tolerance: Annotated[float, Field(gt=0, le=1e-2)] = 1e-9
    """Largest residual force on a node, as a share of the largest element tension."""
    max_iterations: Iterations = 2000
    """Steps before the analysis fails."""


class WaveBand(Part):
    """Equal strips of the wave-frequency response between `from` and `to`, each with its component at its middle."""

    from_: Frequency = Field(0.2, alias="from")
    """Lower end of the band; first-order loads below it are left out."""
    to: Frequency = 1.2
    """Upper end of the band."""
    step: Frequency = 0.005
    """Width of a strip, adjusted so that a whole number fills the band."""

    @model_validator(mode="after")
    def _rising(self) -> WaveBand:
        if self.to <= self.from_:
            raise ValueError(f"`to` {self.to:g} rad/s must be above `from` {self.from_:g} rad/s")
        if (self.to - self.from_) / self.step > 20_000:
            raise ValueError(f"step {self.step:g} rad/s gives more than 20 000 strips; use a wider step")
        return self


class LowBand(Part):
    """Narrow frequency strips of the slow-drift response, at step, 2·step, … up to `to`."""

    to: Frequency = 0.2
    """Border of the bands: results `lf` are of frequencies up to it, results `wf` of those above. It may lie inside the
    wave band. Slow drift of Newman's approximation ends here."""
    step: Frequency = 0.00125
    """Spacing and lowest frequency."""

    @model_validator(mode="after")
    def _fits(self) -> LowBand:
        if self.step > self.to:
            raise ValueError(f"step {self.step:g} rad/s is wider than the band, {self.to:g} rad/s")
        if self.to / self.step > 20_000:
            raise ValueError(f"step {self.step:g} rad/s gives more than 20 000 strips; use a wider step")
        return self


class Difference(Part):
    """Second-order response above the border `low.to`, in strips at their middles. Only with `drift: qtf`."""

    to: Frequency | None = None
    """Highest difference frequency of the second-order loads, in both domains. Default: the largest that the wave band
    and the QTF have."""
    step: Frequency = 0.005
    """Width of a strip, adjusted so that a whole number fits between `low.to` and `to`."""


class FrequencyDomain(Part):
    wave: WaveBand = Field(default_factory=WaveBand)
    """Wave-frequency band: the first-order response."""
    low: LowBand = Field(default_factory=LowBand)
    """Low-frequency band: the second-order response up to the border."""
    difference: Difference = Field(default_factory=Difference)
    """Second-order response above the border; the bands of first and second order may overlap."""
    linearisation: Literal["component", "vector"] = "component"
    """Drag linearised in each of two normal directions (Low & Langley), or frame-invariantly as a vector."""
    include_low_velocities: bool = True
    """Whether slow-drift velocities enter the drag linearisation."""
    tolerance: Annotated[float, Field(gt=0, le=0.1)] = 1e-4
    """Largest relative change of any σ of relative velocity between iterations."""
    max_iterations: Iterations = 100
    """Iterations of the drag linearisation before the analysis fails."""
    storm_duration: Time = 10_800.0
    """Duration for most probable maxima."""

    @model_validator(mode="after")
    def _differences(self) -> FrequencyDomain:
        to, step = self.difference.to, self.difference.step
        if to is not None and to < self.low.to * (1 - 1e-9):
            raise ValueError(
                f"difference.to {to:g} rad/s lies below low.to {self.low.to:g} rad/s; allowed: ≥ {self.low.to:g}, or "
                f"lower low.to"
            )
        highest = self.wave.to - self.wave.from_
        if (highest if to is None else min(to, highest)) / step > 20_000:
            raise ValueError(f"difference.step {step:g} rad/s gives more than 20 000 strips; use a wider step")
        return self


class TimeDomain(Part):
    step: Annotated[Time, Field(le=5)] = 0.05
    """Time step h."""
    build_up: NonNegativeTime = 1200.0
    """Time over which loads ramp up and transients die; left out of statistics."""
    duration: Time = 10_800.0
    """Duration kept for statistics."""
    seeds: Annotated[int, Field(ge=1, le=10_000)] = 1
    """Number of independent realisations."""
    first_seed: Annotated[int, Field(ge=0, le=2**31 - 1)] = 1
    """Seed of the first realisation; the others follow by one."""
    output_step: Time = 0.5
    """Interval at which channels are stored."""
    scheme: Literal["wilson-theta"] = "wilson-theta"
    """Integration scheme."""
    wave_kinematics: Literal["mean", "instantaneous"] = "mean"
    """Where wave kinematics on the lines are evaluated."""
    amplitudes: Literal["fixed", "random"] = "fixed"
    """Fixed amplitudes with random phases, or complex Gaussian amplitudes."""
    wave_step: NonNegativeFrequency = 0.0
    """Spacing of wave components; 0 takes 2π/duration, so that the kept record is one period."""
    tolerance: Annotated[float, Field(gt=0, le=1e-2)] = 1e-6
    """Relative residual at which a step is done."""
    max_iterations: Annotated[int, Field(ge=1, le=200)] = 20
    """Iterations of a step before it is retried smaller."""


class Modes(Part):
    count: Annotated[int, Field(ge=1, le=200)] = 8
    """Number of modes, from the longest period down."""


class Analyses(Part):
    statics: Statics | None = None
    """Static equilibrium; every other analysis starts from it."""
    frequency_domain: FrequencyDomain | None = None
    """Spectra of coupled motion and tension, or amplitudes of a harmonic case."""
    time_domain: TimeDomain | None = None
    """Nonlinear realisations in time: independent seeds of the sea, from rest in the static position."""
    modes: Modes | None = None
    """Natural modes and the coefficients the lines lend the vessel."""

    @model_validator(mode="after")
    def _some(self) -> Analyses:
        if not self.requested():
            raise ValueError("ask for at least one of statics, frequency_domain, time_domain, modes")
        return self

    def requested(self) -> tuple[str, ...]:
        """Names of the analyses asked for, in the order they run."""
        return tuple(name for name in ANALYSES if getattr(self, name) is not None)


ANALYSES = ("statics", "frequency_domain", "time_domain", "modes")
