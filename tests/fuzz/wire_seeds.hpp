#pragma once
#include <filesystem>

/// Seeds of fuzz_wire_session: each message once, and a model written as it should be.
void write_wire_sessions(const std::filesystem::path& folder);
