#include "io/gltf.h"

#include <filesystem>
#include <nlohmann/json.hpp>

namespace chromeball {

std::vector<std::string> gltf_buffers(const std::string& path, std::string_view text) {
    std::vector<std::string> files;
    const auto gltf = nlohmann::json::parse(text, nullptr, false);
    if (!gltf.is_object() || !gltf.contains("buffers")) return files;
    const auto folder = std::filesystem::path(path).parent_path();
    for (const auto& buffer : gltf["buffers"])
        if (buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string())
            files.push_back((folder / buffer["uri"].get<std::string>()).string());
    return files;
}

}  // namespace chromeball
