// SPDX-License-Identifier: Apache-2.0
// Folders that are whole or absent. See atomic_folder.hpp.
#include "sateen/io/atomic_folder.hpp"

#include <unistd.h>

#include <filesystem>
#include <system_error>
#include <utility>

namespace sateen {
namespace {

namespace fs = std::filesystem;

Error failure(const std::string& path, const std::error_code& code) {
    return {Errc::io, path + ": cannot be written: " + code.message()};
}

}  // namespace

Result<AtomicFolder> AtomicFolder::create(const std::string& path) {
    std::error_code code;
    fs::path target(path);
    if (!target.has_filename()) target = target.parent_path();  // ends with a slash
    if (fs::exists(target, code) && !fs::is_directory(target, code))
        return Error{Errc::io, path + ": is a file, expected a folder"};
    const fs::path parent = fs::absolute(target, code).lexically_normal().parent_path();
    fs::create_directories(parent, code);
    if (code) return failure(path, code);
    AtomicFolder folder;
    folder.path_ = path;
    std::string name(".");
    name.append(target.filename().string()).append(".tmp-");
    const fs::path temporary = parent / name.append(std::to_string(getpid()));
    if (!fs::create_directory(temporary, code)) {
        if (!code) code = std::make_error_code(std::errc::file_exists);
        return failure(path, code);
    }
    folder.temporary_ = temporary.string();
    return folder;
}

AtomicFolder::AtomicFolder(AtomicFolder&& other) noexcept
    : path_(std::move(other.path_)), temporary_(std::exchange(other.temporary_, {})) {}

AtomicFolder::~AtomicFolder() {
    std::error_code code;
    if (!temporary_.empty()) fs::remove_all(temporary_, code);
}

Result<void> AtomicFolder::commit() {
    std::error_code code;
    if (!fs::exists(path_, code)) {
        fs::path target(path_);
        if (!target.has_filename()) target = target.parent_path();
        fs::rename(temporary_, target, code);
        if (code) return failure(path_, code);
        temporary_.clear();
        return {};
    }
    for (const auto& file : fs::directory_iterator(temporary_, code)) {
        std::error_code moved;
        fs::rename(file.path(), fs::path(path_) / file.path().filename(), moved);
        if (moved) return failure(path_, moved);
    }
    if (code) return failure(path_, code);
    return {};
}

}  // namespace sateen
