#pragma once

namespace strata {

/// The half-width, around the mean, of a 95 % interval that holds at all times of a watched render:
/// the chance that the intervals shown from `first` to `planned` samples ever miss is 5 %.
/// `variance` is n stderr^2 pooled over the 3x3 block, `samples` those merged so far, all over the
/// replicates of one pixel, with first <= samples <= planned.
double AnytimeHalfWidth(double variance, double samples, double first, double planned);

}  // namespace strata
