// SPDX-License-Identifier: Apache-2.0
// The viewer's page. See web_page.hpp.
#include "web_page.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "sateen/io/atomic_file.hpp"

namespace sateen::cli {
namespace {

constexpr std::size_t kMaxPageBytes = std::size_t{16} << 20U;
constexpr std::string_view kPlace = "<!--sateen-material-->";

std::string attribute(std::string_view text) {
    std::string out;
    for (const char c : text) switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '<':
                out += "&lt;";
                break;
            default:
                out += c;
        }
    return out;
}

}  // namespace

Result<std::string> viewer_page() {
    std::error_code failure;
    const std::filesystem::path program =
        std::filesystem::read_symlink("/proc/self/exe", failure);
    const std::filesystem::path page =
        program.parent_path().parent_path() / "share" / "sateen" / "viewer.html";
    if (failure || !std::filesystem::exists(page, failure))
        return Error{Errc::io,
                     "the viewer is not built: run tools/build_wasm.sh and "
                     "tools/build_viewer.sh, which put it at " +
                         page.string()};
    SATEEN_TRY(const auto bytes, read_file(page.string(), kMaxPageBytes));
    return std::string(bytes.begin(), bytes.end());
}

Result<std::string> page_with_material(std::string page, std::string_view name,
                                       std::span<const std::uint8_t> file) {
    const std::size_t at = page.find(kPlace);
    if (at == std::string::npos)
        return Error{Errc::bad_format,
                     "the viewer's page has no place for a material, expected one from "
                     "tools/build_viewer.sh"};
    page.replace(at, kPlace.size(),
                 fmt::format("<script type=\"text/plain\" id=\"sateen-material\" "
                             "data-name=\"{}\">{}</script>",
                             attribute(name), base64(file)));
    return page;
}

std::string base64(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        std::uint32_t group = std::uint32_t{bytes[i]} << 16U;
        if (left > 1) group |= std::uint32_t{bytes[i + 1]} << 8U;
        if (left > 2) group |= bytes[i + 2];
        out += kDigits[group >> 18U];
        out += kDigits[(group >> 12U) & 63U];
        out += left > 1 ? kDigits[(group >> 6U) & 63U] : '=';
        out += left > 2 ? kDigits[group & 63U] : '=';
    }
    return out;
}

}  // namespace sateen::cli
