#include "tools/rt-trace/device_choice.h"

#include "common/error.h"

#include <epoxy/egl.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

namespace rt {
namespace {

std::optional<unsigned> parseNumber(std::string_view text) {
    unsigned number = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
    constexpr unsigned kMost = 9999;
    if (status != std::errc() || end != text.data() + text.size() || number > kMost) return std::nullopt;
    return number;
}

std::string cudaNumbers(std::span<const ListedDevice> devices) {
    std::string text;
    for (const ListedDevice& device : devices)
        if (device.cuda) text += fmt::format("{}cuda:{}", text.empty() ? "" : ", ", *device.cuda);
    return text.empty() ? "no device has one" : "there are " + text;
}

} // namespace

DeviceRequest parseDevice(const std::string& text, const std::string& source) {
    using Kind = DeviceRequest::Kind;
    const std::string written = source + (source.starts_with('-') ? " " : "=") + text;
    if (text == "auto") return {Kind::Auto, 0, written};
    if (text == "software") return {Kind::Software, 0, written};
    constexpr std::string_view kCuda = "cuda:";
    const bool cuda = text.starts_with(kCuda);
    if (const auto number = parseNumber(std::string_view(text).substr(cuda ? kCuda.size() : 0)))
        return {cuda ? Kind::Cuda : Kind::Index, *number, written};
    throw Error(
        ErrorKind::Usage,
        fmt::format("{}: '{}' is none of auto, software, an index of --list-devices, or cuda:N with a "
                    "number that CUDA gives a device",
                    source, text));
}

bool hasExtension(const char* extensions, const std::string& name) {
    if (!extensions) return false;
    const std::string padded = fmt::format(" {} ", extensions);
    return padded.find(fmt::format(" {} ", name)) != std::string::npos;
}

std::optional<unsigned>
cudaNumber(const char* extensions,
           const std::function<std::optional<std::intptr_t>(std::int32_t attribute)>& queryAttribute) {
    if (!hasExtension(extensions, "EGL_NV_device_cuda")) return std::nullopt;
    const std::optional<std::intptr_t> number = queryAttribute(EGL_CUDA_DEVICE_NV);
    if (!number || *number < 0 || *number > std::numeric_limits<int>::max()) return std::nullopt;
    return static_cast<unsigned>(*number);
}

std::vector<std::size_t> devicesToTry(std::span<const ListedDevice> devices, bool software) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < devices.size(); ++i)
        if (software || !devices[i].software) order.push_back(i);
    const auto rank = [&](std::size_t i) {
        const ListedDevice& device = devices[i];
        if (software) return device.software ? 0u : 1u;
        return device.cuda.value_or(std::numeric_limits<unsigned>::max());
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    return order;
}

std::size_t findDevice(const DeviceRequest& request, std::span<const ListedDevice> devices) {
    if (request.kind == DeviceRequest::Kind::Index) {
        if (request.number < devices.size()) return request.number;
        throw Error(ErrorKind::NoGpu, fmt::format("{}: there are {} devices; see --list-devices",
                                                  request.text, devices.size()));
    }
    for (std::size_t i = 0; i < devices.size(); ++i)
        if (devices[i].cuda == request.number) return i;
    throw Error(ErrorKind::NoGpu,
                fmt::format("{}: no device has this CUDA number: {}; see --list-devices, and "
                            "CUDA_VISIBLE_DEVICES, which hides devices",
                            request.text, cudaNumbers(devices)));
}

} // namespace rt
