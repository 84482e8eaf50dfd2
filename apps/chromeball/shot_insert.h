#pragma once

#include <CLI/App.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/metadata.h"
#include "io/facts.h"
#include "preview_scene.h"
#include "render/scene.h"
#include "shot/pattern.h"

namespace chromeball {

struct Shot;
struct SolveHead;
struct SolvedFrame;

/// What is put into the plates, as typed.
struct InsertOptions {
    std::optional<std::string> mesh;  ///< a name, a file, or a pattern of files, one a frame
    std::optional<std::string> output;
    SceneOptions scene;  ///< of which only the material counts
    double scale = 1;
    int samples = 16;
    bool patch = false;
};
void add_insert_options(CLI::App& command, InsertOptions& options);

/// What was typed wrong, or would write over the plates or maps, before any frame is read. Throws
/// Error (usage).
void check_insert_options(const Shot& shot);
/// One line of what the pictures with an object depend on, besides the frames; empty without one.
std::string insert_words(const InsertOptions& options);

/// Puts an object into every plate, in its ball's place and light. May be used from several
/// threads; the same bytes whoever makes a frame.
class Insert {
public:
    /// Reads a mesh that all frames share. Throws Error.
    Insert(const Shot& shot, const SolveHead& head);
    ~Insert();

    /// A hash of all that the frame's picture is made of. Throws Error where the frame's mesh
    /// cannot be read.
    std::string fingerprint(const SolvedFrame& frame) const;
    bool is_current(const SolvedFrame& frame, const std::string& fingerprint) const;

    /// A plate with the object, in the working space, with what its file will tell of it.
    struct Picture {
        Image pixels;
        Metadata metadata;
        Provenance origin;
        std::vector<std::string> warnings;
    };
    Picture picture(const SolvedFrame& frame) const;
    /// Writes it; tells what the user should know. Throws Error.
    std::vector<std::string> write(const SolvedFrame& frame, Picture picture,
                                   const std::string& fingerprint) const;

private:
    struct Model;
    std::unique_ptr<Model> model_of(int frame, std::vector<std::string>& notes) const;

    const Shot& shot_;
    const SolveHead& head_;
    FramePattern output_;
    std::optional<FramePattern> meshes_;  ///< an animated object's
    std::unique_ptr<Model> shared_;       ///< else
    std::string shared_digest_;
};

}  // namespace chromeball
