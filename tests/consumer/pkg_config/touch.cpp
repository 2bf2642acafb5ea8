// A function of a shared object that has the core in it.
#include "tactree/core/model/nearest.hpp"

bool touch(const tactree::core::BlobView& view) { return nearest_within(view, {}, 1.0F).found(); }
