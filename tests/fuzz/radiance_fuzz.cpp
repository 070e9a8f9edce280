// SPDX-License-Identifier: Apache-2.0
// The image reader that is our own: any bytes as a Radiance picture.
#include <cstddef>
#include <cstdint>

#include "io/codecs.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static_cast<void>(sateen::io::kRadianceFormat.decode({data, size}, "fuzz",
                                                         sateen::Encoding::automatic));
    return 0;
}
