#include "tools/rt-grid/faults.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rt {

void Faults::append(const Faults& later) {
    count += later.count;
    const std::size_t room = std::min(kShown - first.size(), later.first.size());
    first.insert(first.end(), later.first.begin(), later.first.begin() + static_cast<std::ptrdiff_t>(room));
}

Faults findFaults(std::size_t count, std::size_t blockSize, WorkMeter& meter,
                  const std::function<void(std::size_t, std::size_t, Faults&)>& check) {
    std::vector<Faults> ofBlocks(count / blockSize + (count % blockSize != 0));
    meter.begin(ofBlocks.size());
    tbb::parallel_for(std::size_t(0), ofBlocks.size(), [&](std::size_t block) {
        const std::size_t begin = block * blockSize;
        check(begin, begin + std::min(blockSize, count - begin), ofBlocks[block]);
        meter.add();
    });
    Faults all;
    for (const Faults& faults : ofBlocks) all.append(faults);
    return all;
}

} // namespace rt
