# Run as a script by lambent_as_cpp: rewrites the shader IN to OUT. Lines stay where they are, so that compilers and
# debuggers show the shader itself.
file(READ "${IN}" text)
string(REGEX MATCHALL "#define +[A-Za-z_]+" defined "${text}")
# Rooms' headers that both languages share are included by the class's header. Functions of a class need no declaration.
string(REGEX REPLACE "#include \"[a-z_]+\\.h\"" "" text "${text}")
string(REGEX REPLACE "\n[A-Za-z0-9]+ [A-Za-z0-9]+\\([^{};]*\\);" "\n" text "${text}")
string(REGEX REPLACE "\nconst " "\nstatic inline const " text "${text}")
# Bindings become members.
string(REGEX REPLACE "\nlayout\\(local_size_x = ([A-Za-z0-9]+)\\) in;" "\nstatic constexpr uint kInvocations = \\1;" text "${text}")
string(REGEX REPLACE "\nlayout\\(local_size_x[^\n]*" "\n" text "${text}")
string(REGEX REPLACE "\nlayout\\([^{]*readonly buffer [A-Za-z]+ {([^}]* |)([A-Za-z0-9]+) ([a-z_]+)\\[\\]; };" "\n\\1std::span<const \\2> \\3;" text "${text}")
string(REGEX REPLACE "\nlayout\\([^{]*buffer [A-Za-z]+ {([^}]* |)([A-Za-z0-9]+) ([a-z_]+)\\[\\]; };" "\n\\1std::span<\\2> \\3;" text "${text}")
string(REGEX REPLACE "\nlayout\\([^)]*\\) (writeonly |readonly )?uniform " "\n" text "${text}")
string(REPLACE "\nshared " "\n" text "${text}")
# Parameters that a function writes are references, literals are floats, and runtime/base/glsl.hpp has the swizzles.
string(REGEX REPLACE "([(, ])(in)?out ([A-Za-z0-9]+) ([a-z0-9_]+)(\\[[^]]*\\])" "\\1\\3 (&\\4)\\5" text "${text}")
string(REGEX REPLACE "([(, ])(in)?out ([A-Za-z0-9]+) ([a-z0-9_]+)" "\\1\\3& \\4" text "${text}")
string(REGEX REPLACE "([0-9]+\\.[0-9]+(e[-+]?[0-9]+)?)" "\\1f" text "${text}")
string(REGEX REPLACE "([^0-9A-Za-z_.])([0-9]+e[-+]?[0-9]+)" "\\1\\2f" text "${text}")
string(REGEX REPLACE "\\.(xyz|xy|zw|rgb|rg)([^A-Za-z0-9_])" "->*\\1\\2" text "${text}")
list(TRANSFORM defined REPLACE "#define +" "#undef ")
string(REPLACE ";" "\n" defined "${defined}")
file(WRITE "${OUT}" "#line 1 \"${IN}\"\n${text}\n${defined}\n")
