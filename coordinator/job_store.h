#pragma once

namespace strata {

class JobStore {
 public:
  virtual ~JobStore() = default;
};

}  // namespace strata
