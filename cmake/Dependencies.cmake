# Everything here is a Debian 12 package; the names stand in packages.txt.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(Ceres REQUIRED)
find_package(Boost REQUIRED)  # headers only: Boost.Math
# Debian's VTK refers to MPI's targets without finding them itself.
find_package(MPI REQUIRED COMPONENTS C CXX)
find_package(VTK 9.1 REQUIRED COMPONENTS
  CommonCore CommonDataModel CommonExecutionModel IOCore IOXML IOXMLParser IOGeometry IOPLY
  FiltersCore FiltersSources IOImage
  RenderingCore RenderingOpenGL2 RenderingContext2D RenderingContextOpenGL2 RenderingFreeType)

# Debian builds libsystemc as C++17 and it checks the language level at link time.
pkg_check_modules(SYSTEMC REQUIRED IMPORTED_TARGET systemc)
add_library(hvp_systemc INTERFACE)
target_include_directories(hvp_systemc SYSTEM INTERFACE ${SYSTEMC_INCLUDE_DIRS})
target_link_libraries(hvp_systemc INTERFACE PkgConfig::SYSTEMC Threads::Threads)
target_compile_definitions(hvp_systemc INTERFACE SC_CPLUSPLUS=201703L)

find_path(TETGEN_INCLUDE_DIR tetgen.h REQUIRED)
find_library(TETGEN_LIBRARY tet REQUIRED)
add_library(hvp_tetgen INTERFACE)
target_include_directories(hvp_tetgen SYSTEM INTERFACE ${TETGEN_INCLUDE_DIR})
target_link_libraries(hvp_tetgen INTERFACE ${TETGEN_LIBRARY})
target_compile_definitions(hvp_tetgen INTERFACE TETLIBRARY)

find_path(METIS_INCLUDE_DIR metis.h REQUIRED)
find_library(METIS_LIBRARY metis REQUIRED)
add_library(hvp_metis INTERFACE)
target_include_directories(hvp_metis SYSTEM INTERFACE ${METIS_INCLUDE_DIR})
target_link_libraries(hvp_metis INTERFACE ${METIS_LIBRARY})
