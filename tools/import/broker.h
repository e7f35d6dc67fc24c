// The sandboxed reader may not open files: it asks its parent for descriptors over a socket pair.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace sinew::import {

/// Child: asks for a file by name and waits for its descriptor; -1 when it is refused.
int request_file(int socket, const std::string& name);

/// Parent: takes one request and answers it with `open_file(name)`, whose descriptor it closes. False when
/// the other end is gone or talks nonsense.
bool serve_request(int socket, const std::function<int(const std::string&)>& open_file);

/// Descriptor of the regular file `name` in `directory` or below, or -1. Refuses absolute names, "..", links
/// that lead out of the directory and files of more than `most` bytes.
int open_below(const std::filesystem::path& directory, const std::string& name, std::uint64_t most);

/// The same in the directory of the file `source`.
int open_beside(const std::filesystem::path& source, const std::string& name, std::uint64_t most);

}  // namespace sinew::import
