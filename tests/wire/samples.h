#pragma once

#include "common/messages.h"
#include "common/report.h"

// Values of which every field differs from its default, so that a forgotten one shows.

namespace strata {

JobSpec SampleSpec();
JobStatus SampleStatus();
WorkerStatus SampleWorker();
/// `width` x `height` pixels with values that differ in each place; samples differ between pixels
/// if `varied`.
UnitResult SampleResult(int width, int height, bool varied);
std::vector<FromWorker> SampleFromWorker();
std::vector<ToWorker> SampleToWorker();

}  // namespace strata
