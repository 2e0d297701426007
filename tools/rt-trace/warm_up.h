#pragma once
#include <functional>
#include <span>

namespace rt {

/// Does something again and again until the device has come up to its clock; once at least.
void warmUp(const std::function<void()>& pass);

/// Of sorted values, at least one.
double medianOf(std::span<const double> sorted);

} // namespace rt
