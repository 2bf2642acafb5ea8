#pragma once
#include <filesystem>

/// Seeds of fuzz_wire_session: each message once, and the correct transfer of a model.
void write_wire_sessions(const std::filesystem::path& folder);
