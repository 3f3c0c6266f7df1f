#include "worker/integrator/render_pixels.h"

namespace strata {

template void Renderer::State::RenderPixels<SobolSampler>(const WorkUnit&, int64_t, int64_t,
                                                          Partial&, DefectList&) const;

}  // namespace strata
