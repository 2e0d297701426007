#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rt {

/// What a user may ask for.
struct DeviceRequest {
    enum class Kind { Auto, Software, Index, Cuda };
    Kind kind = Kind::Auto;
    unsigned number = 0; ///< of Index and Cuda
    std::string text;    ///< as it was written, and where: "--device 3"
};

/// "auto", "software", "N" or "cuda:N". `source`: the option or variable that it comes from. Throws
/// Error{Usage}.
DeviceRequest parseDevice(const std::string& text, const std::string& source);

/// What EGL says of a device before it is opened.
struct ListedDevice {
    bool software = false;
    std::optional<unsigned> cuda; ///< number that CUDA gives it
};

/// The device's EGL_CUDA_DEVICE_NV: its number among those that CUDA_VISIBLE_DEVICES lets this process see.
/// Nothing for the others, and for devices that are none of CUDA's. `extensions`: the device's.
/// `queryAttribute`: eglQueryDeviceAttribEXT() of it; nothing where that fails.
std::optional<unsigned>
cudaNumber(const char* extensions,
           const std::function<std::optional<std::intptr_t>(std::int32_t attribute)>& queryAttribute);

/// Whether a list of EGL extensions, which may be a null pointer, has this one.
bool hasExtension(const char* extensions, const std::string& name);

/// Which devices to try, one after the other, if any of hardware, or of software, will do. Those that CUDA
/// numbers come first, as it does: what CUDA_VISIBLE_DEVICES hides is somebody else's. Devices that count as
/// hardware may turn out to be software, so those are tried for it too, last.
std::vector<std::size_t> devicesToTry(std::span<const ListedDevice> devices, bool software);

/// Where the device that is asked for, by index or CUDA's number, stands in the list. Throws Error{NoGpu} if
/// it is not there.
std::size_t findDevice(const DeviceRequest& request, std::span<const ListedDevice> devices);

} // namespace rt
