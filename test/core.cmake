# Unit tests of the core.

# --- small parts ---
perennial_gtest(note_limit_test core/note_limit_test.cpp)
perennial_gtest(parameter_reader_test core/parameter_reader_test.cpp)
perennial_gtest(restart_watch_test core/restart_watch_test.cpp)
perennial_gtest(utc_time_test core/utc_time_test.cpp)

# --- features and registration ---
perennial_gtest(features_test
  core/features/brief_descriptor_test.cpp
  core/features/duplicate_filter_test.cpp
  core/features/edge_field_test.cpp
  core/features/extraction_settings_test.cpp
  core/features/feature_extractor_test.cpp
  core/features/half_and_buckets_test.cpp
  core/features/hessian_pyramid_test.cpp
  core/features/integral_image_test.cpp
  core/features/maxima_test.cpp
  core/features/orientation_descriptor_test.cpp
  core/features/repeatability_test.cpp
  core/features/surf_detector_test.cpp
  LIBRARIES opencv_imgproc opencv_imgcodecs
  DEFINITIONS PERENNIAL_DEFAULT_DATA="${PROJECT_SOURCE_DIR}/../shared/data"
)
perennial_gtest(features_allocation_test core/features/allocation_test.cpp LIBRARIES opencv_imgproc)
if(hwy_FOUND AND PERENNIAL_VECTOR_CODE)
  set(vector_code PERENNIAL_HAS_VECTOR_CODE)
endif()
perennial_gtest(kernels_test core/simd/kernels_test.cpp LIBRARIES opencv_imgproc DEFINITIONS ${vector_code})
perennial_gtest(registration_test
  core/registration_test.cpp
  core/registration/edge_correlation_test.cpp
  core/registration/robust_registration_test.cpp
  core/registration/votes_test.cpp
)
perennial_gtest(pairs_evaluation_test
  core/disturbance_test.cpp
  core/pairs_evaluation_test.cpp
  LIBRARIES opencv_imgproc opencv_imgcodecs
)

# --- navigation ---
perennial_gtest(motion_interlock_test core/motion_interlock_test.cpp)
perennial_gtest(navigation_supervisor_test core/navigation_supervisor_test.cpp)
perennial_gtest(path_following_test core/path_following_test.cpp)
perennial_gtest(place_finder_test core/place_finder_test.cpp)

# --- maps ---
perennial_gtest(map_damage_test core/map_damage_test.cpp LIBRARIES SQLite::SQLite3)
perennial_gtest(map_fault_test core/map_fault_test.cpp core/faulty_vfs.cpp LIBRARIES SQLite::SQLite3)
perennial_gtest(map_file_test core/map_file_test.cpp)
set(format1_map FORMAT1_MAP="${CMAKE_CURRENT_SOURCE_DIR}/data/format1.perennial")
perennial_gtest(map_migration_test core/map_migration_test.cpp
  LIBRARIES perennial_strategies SQLite::SQLite3
  DEFINITIONS ${format1_map}
)
perennial_gtest(map_migration_fault_test
  core/failing_calls.cpp
  core/faulty_vfs.cpp
  core/map_migration_fault_test.cpp
  core/unsynced_changes.cpp
  LIBRARIES SQLite::SQLite3 ${CMAKE_DL_LIBS}
  DEFINITIONS ${format1_map}
)
perennial_gtest(map_name_test core/map_name_test.cpp)
perennial_gtest(map_power_test core/failing_calls.cpp core/map_power_test.cpp core/unsynced_changes.cpp
  LIBRARIES SQLite::SQLite3 ${CMAKE_DL_LIBS}
  DEFINITIONS ${format1_map}
)
perennial_gtest(map_tool_test core/map_tool_test.cpp
  LIBRARIES opencv_imgcodecs ${YAML_CPP_LIBRARIES}
  DEFINITIONS MAP_TOOL="$<TARGET_FILE:map_tool>" ${format1_map}
  DEPENDS map_tool
)
if(TARGET map_tool_test)
  target_include_directories(map_tool_test SYSTEM PRIVATE ${YAML_CPP_INCLUDE_DIR})
endif()
perennial_gtest(map_update_test core/map_update_test.cpp)
perennial_gtest(map_writer_test core/map_writer_test.cpp)

# --- strategies ---
perennial_gtest(anchored_map_test core/anchored_map_test.cpp LIBRARIES perennial_strategies)
perennial_gtest(fremen_model_test core/fremen_model_test.cpp)
perennial_gtest(strategies_test core/strategies_test.cpp LIBRARIES perennial_strategies)
perennial_gtest(strategy_settings_test core/strategy_settings_test.cpp LIBRARIES perennial_strategies)
# The conformance suite over strategies that are broken on purpose, to be run by a test that expects it to find them.
add_executable(broken_strategies EXCLUDE_FROM_ALL core/broken_strategies.cpp)
target_link_libraries(broken_strategies perennial_core gtest gtest_main)
perennial_gtest(conformance_suite_test core/conformance_suite_test.cpp
  DEFINITIONS BROKEN_STRATEGIES="$<TARGET_FILE:broken_strategies>"
  DEPENDS broken_strategies
)

# --- all of it ---
perennial_gtest(dataset_test core/dataset_test.cpp LIBRARIES opencv_imgcodecs)
perennial_gtest(long_run_test core/long_run_test.cpp LIBRARIES perennial_strategies opencv_imgproc)
perennial_gtest(teach_repeat_test core/teach_repeat_test.cpp LIBRARIES perennial_strategies opencv_imgproc)
