# Unit tests of the evaluation, and its tools.
perennial_gtest(evaluation_test
  evaluation/paired_test_test.cpp
  evaluation/reference_dataset_test.cpp
  evaluation/replay_input_test.cpp
  evaluation/replay_test.cpp
  evaluation/run_results_test.cpp
  evaluation/run_settings_test.cpp
  LIBRARIES perennial_evaluation perennial_strategies opencv_imgproc opencv_imgcodecs
  DEFINITIONS SWEEPS="${PROJECT_SOURCE_DIR}/config/sweeps"
)
# What reads the reference system's files and tables is in the core.
set_property(GLOBAL APPEND PROPERTY perennial_core_tests evaluation_test)
perennial_gtest(evaluation_tools_test evaluation/tools_test.cpp
  LIBRARIES opencv_imgproc opencv_imgcodecs
  DEFINITIONS EVALUATE="$<TARGET_FILE:evaluate>" REPORT="$<TARGET_FILE:report>"
  DEPENDS evaluate report perennial_strategies
)
