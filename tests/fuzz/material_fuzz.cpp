// SPDX-License-Identifier: Apache-2.0
// Material files from anywhere: an error or a valid material, never a crash. The first
// byte chooses between the payload alone and the file with its gzip wrapping.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

// What decodes is valid, encodes, and is the same when it is decoded again.
void check(const sateen::Material& material) {
    require(sateen::validate(material).has_value());
    const auto payload = sateen::write_material(material);
    require(payload.has_value());
    const auto again = sateen::read_material(*payload);
    require(again.has_value());
    const auto twice = sateen::write_material(*again);
    require(twice.has_value() && *twice == *payload);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::span file(data + 1, size - 1);
    const auto material =
        data[0] % 2 == 0 ? sateen::read_material(file) : sateen::unpack_material(file);
    if (material) check(*material);
    return 0;
}
